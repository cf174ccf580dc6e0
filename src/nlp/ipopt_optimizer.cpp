// Ipopt with the exact Hessian and with its limited-memory one. Facts this file works around (Ipopt
// 3.11 of Debian): two solves at once crash inside MUMPS, which stands in where our own linear
// solver does not, and without it race for a flag of Ipopt's own; Initialize() would read ipopt.opt
// from the current folder; infinity is any number beyond 1e19; a refused evaluation is `false`.
#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <cmath>
#include <mutex>

#include "nlp/adapters.hpp"
#include "nlp/ipopt_linear_solver.hpp"
#include "nlp/monitor.hpp"

namespace stillbase::nlp {
namespace {

using Ipopt::Index;
using Ipopt::Number;

// Module variables of MUMPS are shared by all its instances, and every solve writes whether Ipopt's
// banner was printed: one solve at a time in the process. A model must therefore not run Ipopt
// itself.
std::mutex& solve_mutex() {
  static std::mutex mutex;
  return mutex;
}

void copy_bounds(const Eigen::VectorXd& from, Number* to) {
  for (Eigen::Index i = 0; i < from.size(); ++i) to[i] = std::clamp(from[i], -2e19, 2e19);
}

class MonitoredNlp final : public Ipopt::TNLP {
 public:
  MonitoredNlp(Monitor& monitor, const Eigen::VectorXd& start, bool exact_hessian)
      : monitor_(monitor), start_(start), exact_hessian_(exact_hessian) {}

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jacobian, Index& nnz_hessian,
                    IndexStyleEnum& index_style) override {
    n = static_cast<Index>(start_.size());
    m = static_cast<Index>(monitor_.constraint_lower().size());
    nnz_jacobian = n * m;
    nnz_hessian = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index, Number* lower, Number* upper, Index, Number* g_lower,
                       Number* g_upper) override {
    copy_bounds(monitor_.lower(), lower);
    copy_bounds(monitor_.upper(), upper);
    copy_bounds(monitor_.constraint_lower(), g_lower);
    copy_bounds(monitor_.constraint_upper(), g_upper);
    return true;
  }

  bool get_starting_point(Index, bool, Number* x, bool init_z, Number*, Number*, Index,
                          bool init_lambda, Number*) override {
    std::copy(start_.begin(), start_.end(), x);
    return !init_z && !init_lambda;
  }

  bool eval_f(Index, const Number* x, bool, Number& f) override {
    const Evaluation* e = monitor_.evaluate(x);
    if (e != nullptr) f = e->objective;
    return e != nullptr;
  }

  bool eval_grad_f(Index, const Number* x, bool, Number* gradient) override {
    const Evaluation* e = monitor_.evaluate(x);
    if (e != nullptr) std::copy(e->gradient.begin(), e->gradient.end(), gradient);
    return e != nullptr;
  }

  bool eval_g(Index, const Number* x, bool, Index, Number* g) override {
    const Evaluation* e = monitor_.evaluate(x);
    if (e != nullptr) std::copy(e->constraints.begin(), e->constraints.end(), g);
    return e != nullptr;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index m, Index, Index* rows, Index* columns,
                  Number* values) override {
    const Evaluation* e = values != nullptr ? monitor_.evaluate(x) : nullptr;
    if (values != nullptr && e == nullptr) return false;
    for (Index i = 0, k = 0; i < m; ++i) {
      for (Index j = 0; j < n; ++j, ++k) {
        if (values != nullptr) {
          values[k] = e->jacobian(i, j);
        } else {
          rows[k] = i;
          columns[k] = j;
        }
      }
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number sigma, Index, const Number* multipliers, bool,
              Index, Index* rows, Index* columns, Number* values) override {
    if (!exact_hessian_) return false;
    if (values != nullptr && !monitor_.lagrangian_hessian(x, sigma, multipliers, hessian_)) {
      return false;
    }
    for (Index i = 0, k = 0; i < n; ++i) {
      for (Index j = 0; j <= i; ++j, ++k) {
        if (values != nullptr) {
          values[k] = hessian_(i, j);
        } else {
          rows[k] = i;
          columns[k] = j;
        }
      }
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number,
                             Number, Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return !monitor_.stopped();
  }

  void finalize_solution(Ipopt::SolverReturn, Index, const Number*, const Number*, const Number*,
                         Index, const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {}  // the monitor has the best

 private:
  Monitor& monitor_;
  const Eigen::VectorXd& start_;
  const bool exact_hessian_;
  Eigen::MatrixXd hessian_;
};

const char* text_of(Ipopt::ApplicationReturnStatus code) {
#define STILLBASE_TEXT(name) \
  if (code == Ipopt::name) return #name;
  STILLBASE_TEXT(Solve_Succeeded)
  STILLBASE_TEXT(Solved_To_Acceptable_Level)
  STILLBASE_TEXT(Infeasible_Problem_Detected)
  STILLBASE_TEXT(Search_Direction_Becomes_Too_Small)
  STILLBASE_TEXT(Diverging_Iterates)
  STILLBASE_TEXT(User_Requested_Stop)
  STILLBASE_TEXT(Feasible_Point_Found)
  STILLBASE_TEXT(Maximum_Iterations_Exceeded)
  STILLBASE_TEXT(Restoration_Failed)
  STILLBASE_TEXT(Error_In_Step_Computation)
  STILLBASE_TEXT(Maximum_CpuTime_Exceeded)
  STILLBASE_TEXT(Not_Enough_Degrees_Of_Freedom)
  STILLBASE_TEXT(Invalid_Problem_Definition)
  STILLBASE_TEXT(Invalid_Option)
  STILLBASE_TEXT(Invalid_Number_Detected)
  STILLBASE_TEXT(Unrecoverable_Exception)
  STILLBASE_TEXT(NonIpopt_Exception_Thrown)
  STILLBASE_TEXT(Insufficient_Memory)
  STILLBASE_TEXT(Internal_Error)
#undef STILLBASE_TEXT
  return "unknown";
}

// Of a linear system: variables, and a slack and a multiplier per constraint. Beyond it MUMPS,
// which knows zeros, takes less time than a dense factorisation.
constexpr Eigen::Index kMostUnknowns = 160;

constexpr const char* kTuning =
    "tol 1e-10, constr_viol_tol 5e-10, acceptable_iter 0, bound_relax_factor 0, "
    "mumps_mem_percent 10";

class IpoptOptimizer final : public Optimizer {
 public:
  IpoptOptimizer(std::string name, std::string about, bool exact_hessian)
      : Optimizer({.name = std::move(name),
                   .about = std::move(about),
                   .uses_gradient = true,
                   .uses_hessian = exact_hessian,
                   .library = "Ipopt " IPOPT_VERSION,
                   .tuning = kTuning}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    const bool exact_hessian = info().uses_hessian && monitor.problem().has_hessian();
    const std::lock_guard lock(solve_mutex());
    // Registers all options once: a twentieth of the solve of a small problem.
    static const Ipopt::SmartPtr<Ipopt::IpoptApplication> prototype =
        new Ipopt::IpoptApplication(false);
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = prototype->clone();
    application->RethrowNonIpoptException(false);
    const Eigen::Index unknowns = start.size() + 2 * monitor.constraint_lower().size();
    if (!set_options(*application->Options(), options, exact_hessian, unknowns)) {
      return {Ipopt::Invalid_Option, "Invalid_Option", ""};
    }
    Ipopt::ApplicationReturnStatus code = application->Initialize("");  // reads no options file
    if (code == Ipopt::Solve_Succeeded) {
      const Ipopt::SmartPtr<Ipopt::TNLP> nlp = new MonitoredNlp(monitor, start, exact_hessian);
      code = application->OptimizeTNLP(nlp);
    }
    NativeOutcome outcome{code, text_of(code), ""};
    if (info().uses_hessian && !exact_hessian) {
      outcome.remark = "the problem has no exact Hessian: limited-memory approximation used";
    }
    return outcome;
  }

  static bool set_options(Ipopt::OptionsList& list, const OptimizeOptions& options,
                          bool exact_hessian, Eigen::Index unknowns) {
    bool ok = list.SetIntegerValue("print_level", 0);
    ok = list.SetStringValue("sb", "yes") && ok;
    ok = list.SetStringValue("hessian_approximation", exact_hessian ? "exact" : "limited-memory") &&
         ok;
    // Each iteration evaluates at least one point, so that the monitor's budget ends first.
    ok = list.SetIntegerValue("max_iter", std::max(1, options.max_evaluations)) && ok;
    // Which one there is depends on how Ipopt was built: no option of the method, and the same with
    // the library's own options.
    const bool is_own = unknowns <= kMostUnknowns && provides_linear_solver();
    ok = list.SetStringValue("linear_solver", is_own ? "ma27" : "mumps") && ok;
    if (is_own) {
      // Ours scales by itself, bounds its pivots by itself and asks for all the memory that it
      // uses.
      ok = list.SetStringValue("linear_system_scaling", "none") && ok;
      ok = list.SetNumericValue("ma27_pivtol", 1e-8) && ok;
      ok = list.SetNumericValue("ma27_pivtolmax", 1e-8) && ok;
      ok = list.SetNumericValue("ma27_la_init_factor", 1.0) && ok;
    }
    if (options.library_defaults) return ok;
    // Room beyond MUMPS' estimate, in percent; default 1000, which a small problem spends more time
    // on allocating than on its numbers. Where it is too little Ipopt doubles it and repeats.
    ok = list.SetIntegerValue("mumps_mem_percent", 10) && ok;
    // Below our own tolerance, because it is measured on the scaled problem and because the
    // distance from an active bound is about this over the multiplier.
    ok = list.SetNumericValue("tol", 1e-4 * options.optimality_tolerance) && ok;
    ok = list.SetNumericValue("constr_viol_tol", 0.5 * options.feasibility_tolerance) && ok;
    // "Acceptable" means the tolerances above are missed: the judge would not accept it.
    ok = list.SetIntegerValue("acceptable_iter", 0) && ok;
    // Relaxed bounds (default 1e-8) would be violated bounds.
    ok = list.SetNumericValue("bound_relax_factor", 0.0) && ok;
    return ok;
  }
};

}  // namespace

Optimizers ipopt_optimizers() {
  Optimizers out;
  out.push_back(std::make_unique<IpoptOptimizer>("ipopt", "interior point, exact Hessian", true));
  out.push_back(std::make_unique<IpoptOptimizer>("ipopt-lbfgs",
                                                 "interior point, limited-memory BFGS", false));
  return out;
}

}  // namespace stillbase::nlp

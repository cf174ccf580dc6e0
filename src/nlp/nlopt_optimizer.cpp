// Every `nlopt-*` name is one row of kTable. Facts this file works around (NLopt 2.7.1): success is
// reported on infeasible problems, so its word is only recorded; most algorithms refuse equations
// and are wrapped in an augmented Lagrangian; the random generator is per thread and seeded per
// solve. The C interface is used because exceptions lose their type in the C++ one.
#include <nlopt.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <type_traits>

#include "nlp/adapters.hpp"
#include "nlp/monitor.hpp"
#include "nlp/stuck_watch.hpp"

namespace stillbase::nlp {
namespace {

enum class Handles { Bounds, Inequalities, Everything };

// What a point where the model is undefined looks like to the solver.
enum class Rejection {
  Infinite,  // its line search or trust region is known to shorten the step on it
  Large,     // its arithmetic would turn infinity into NaN: a finite value worse than all seen
};

struct Row {
  const char* name;
  const char* about;
  nlopt_algorithm algorithm;
  Handles handles;
  Rejection rejection;
  bool uses_gradient;
  bool global;
  bool stochastic;
  int min_variables;
};

constexpr Row kTable[] = {
    // clang-format off
    // name                  about                                            algorithm          handles                rejection            grad   global random N
    {"nlopt-slsqp",        "sequential quadratic programming (Kraft)",        NLOPT_LD_SLSQP,    Handles::Everything,   Rejection::Infinite, true,  false, false, 1},
    {"nlopt-auglag-lbfgs", "augmented Lagrangian, limited-memory BFGS",       NLOPT_LD_LBFGS,    Handles::Bounds,       Rejection::Large,    true,  false, false, 1},
    {"nlopt-auglag-mma",   "augmented Lagrangian, moving asymptotes",         NLOPT_LD_MMA,      Handles::Inequalities, Rejection::Infinite, true,  false, false, 1},
    {"nlopt-ccsaq",        "conservative convex separable approximation",     NLOPT_LD_CCSAQ,    Handles::Inequalities, Rejection::Infinite, true,  false, false, 1},
    {"nlopt-cobyla",       "linear models in a trust region, no derivatives", NLOPT_LN_COBYLA,   Handles::Everything,   Rejection::Large,    false, false, false, 1},
    {"nlopt-bobyqa",       "quadratic models in a trust region, no derivatives", NLOPT_LN_BOBYQA, Handles::Bounds,      Rejection::Large,    false, false, false, 2},
    {"nlopt-crs2",         "controlled random search with local mutation",    NLOPT_GN_CRS2_LM,  Handles::Bounds,       Rejection::Large,    false, true,  true,  1},
    {"nlopt-isres",        "evolution strategy with stochastic ranking",      NLOPT_GN_ISRES,    Handles::Everything,   Rejection::Large,    false, true,  true,  1},
    {"nlopt-esch",         "evolutionary algorithm",                          NLOPT_GN_ESCH,     Handles::Bounds,       Rejection::Large,    false, true,  true,  1},
    {"nlopt-direct-l",     "dividing rectangles, biased to local search",     NLOPT_GN_DIRECT_L, Handles::Bounds,       Rejection::Large,    false, true,  false, 1},
    {"nlopt-mlsl",         "multi-level single linkage over limited-memory BFGS", NLOPT_G_MLSL_LDS, Handles::Bounds,    Rejection::Large,    true,  true,  true,  1},
    {"nlopt-stogo",        "branch and bound with local searches",            NLOPT_GD_STOGO,    Handles::Bounds,       Rejection::Large,    true,  true,  false, 1},
    // clang-format on
};

// StoGO is only in libraries that were built with C++.
bool is_compiled(const Row& row) {
  return std::string_view(nlopt_algorithm_name(row.algorithm)).find("NOT COMPILED") ==
         std::string_view::npos;
}

struct OptDeleter {
  void operator()(nlopt_opt opt) const { nlopt_destroy(opt); }
};
using Opt = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, OptDeleter>;

// One row h(x) = sign (g_i(x) - bound), wanted = 0 or <= 0.
struct ConstraintRow {
  Eigen::Index index;
  double sign;
  double bound;
};

struct Context {
  Monitor& monitor;
  nlopt_opt opt;
  Rejection rejection;
  bool is_watched = false;  // for getting stuck
  double scale = 1.0;       // of the objective
  StuckWatch watch = {};
};

struct ConstraintContext {
  Context* context;
  std::vector<ConstraintRow> rows;
};

double worst_violation(const Monitor& monitor, const Evaluation& e) {
  if (monitor.constraint_lower().size() == 0) return 0.0;
  return signed_violation(e.constraints, monitor.constraint_lower(), monitor.constraint_upper())
      .lpNorm<Eigen::Infinity>();
}

const Evaluation* evaluate(Context& context, const double* x) {
  const int before = context.monitor.evaluations();
  const Evaluation* e = context.monitor.evaluate(x);
  const bool is_new = context.monitor.evaluations() > before;
  if (context.is_watched && is_new && e != nullptr) {
    context.watch.look_at(worst_violation(context.monitor, *e));
  }
  if (context.monitor.stopped() || context.watch.is_stuck()) nlopt_force_stop(context.opt);
  return e;
}

double objective(unsigned n, const double* x, double* gradient, void* data) {
  Context& context = *static_cast<Context*>(data);
  const Evaluation* e = evaluate(context, x);
  if (gradient != nullptr) {
    for (unsigned j = 0; j < n; ++j)
      gradient[j] = e != nullptr ? context.scale * e->gradient[j] : 0.0;
  }
  if (e != nullptr) return context.scale * e->objective;
  return context.rejection == Rejection::Infinite && !context.monitor.stopped()
             ? HUGE_VAL
             : context.monitor.rejection_value();
}

void constraints(unsigned m, double* result, unsigned n, const double* x, double* gradient,
                 void* data) {
  const ConstraintContext& constraint = *static_cast<ConstraintContext*>(data);
  const Evaluation* e = evaluate(*constraint.context, x);
  for (unsigned i = 0; i < m; ++i) {
    const ConstraintRow& row = constraint.rows[i];
    result[i] = e != nullptr ? row.sign * (e->constraints[row.index] - row.bound) : 0.0;
    if (gradient == nullptr) continue;
    for (unsigned j = 0; j < n; ++j) {
      gradient[i * n + j] = e != nullptr ? row.sign * e->jacobian(row.index, j) : 0.0;
    }
  }
}

// Stopping values. The solvers' own tests look at steps, not at optimality, so they are set near
// rounding: a superlinear method pays one or two evaluations for it, and our certificate judges.
void set_tolerances(nlopt_opt opt) {
  nlopt_set_ftol_rel(opt, 1e-15);
  nlopt_set_xtol_rel(opt, 1e-11);
  nlopt_set_xtol_abs1(opt, 1e-12);  // for variables that go to zero
  // The default takes as many pairs as fit in 10 MB, which costs milliseconds for a small problem.
  nlopt_set_vector_storage(opt, 20);
  // MMA and CCSAQ solve a dual problem per step, at no evaluation; the default of 100000 steps
  // there lets one evaluation take seconds where rows are nearly parallel.
  nlopt_set_param(opt, "dual_maxeval", 300);
}

constexpr const char* kNloptTuning =
    "ftol_rel 1e-15, xtol_rel 1e-11, xtol_abs 1e-12, vector_storage 20, dual_maxeval 300; in an "
    "augmented Lagrangian ftol_rel 1e-13, xtol_rel and xtol_abs 1e-9; sequential quadratic "
    "programming runs a second time with a first step of 0.1 when a violation stays";

std::string library_version() {
  int major = 0, minor = 0, bugfix = 0;
  nlopt_version(&major, &minor, &bugfix);
  return "NLopt " + std::to_string(major) + "." + std::to_string(minor) + "." +
         std::to_string(bugfix);
}

// Inside an augmented Lagrangian: the limited-memory BFGS answers a step lost in rounding with a
// failure that ends everything, so it must stop before; the outer iteration makes up for the
// digits.
void set_inner_tolerances(nlopt_opt opt) {
  set_tolerances(opt);
  nlopt_set_ftol_rel(opt, 1e-13);
  nlopt_set_xtol_rel(opt, 1e-9);
  nlopt_set_xtol_abs1(opt, 1e-9);
}

class NloptOptimizer final : public Optimizer {
 public:
  explicit NloptOptimizer(const Row& row)
      : Optimizer({.name = row.name,
                   .about = row.about,
                   .uses_gradient = row.uses_gradient,
                   .uses_hessian = false,
                   .global = row.global,
                   .stochastic = row.stochastic,
                   .min_variables = row.min_variables,
                   .library = library_version(),
                   .tuning = kNloptTuning}),
        row_(row) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    const unsigned n = static_cast<unsigned>(start.size());
    ConstraintContext equations{nullptr, {}}, inequalities{nullptr, {}};
    for (Eigen::Index i = 0; i < monitor.constraint_lower().size(); ++i) {
      const double lower = monitor.constraint_lower()[i], upper = monitor.constraint_upper()[i];
      if (lower == upper) {
        equations.rows.push_back({i, 1.0, upper});
        continue;
      }
      if (std::isfinite(upper)) inequalities.rows.push_back({i, 1.0, upper});
      if (std::isfinite(lower)) inequalities.rows.push_back({i, -1.0, lower});
    }
    const bool wrapped = (!equations.rows.empty() && row_.handles != Handles::Everything) ||
                         (!inequalities.rows.empty() && row_.handles == Handles::Bounds);

    // AUGLAG_EQ would leave the inequalities to the inner solver; with MMA and CCSAQ inside it did
    // not end in 20000 evaluations on HS071, where AUGLAG needs 950.
    const nlopt_algorithm outer = wrapped ? NLOPT_AUGLAG : row_.algorithm;
    const Opt opt(nlopt_create(outer, n));
    if (!opt) return {NLOPT_OUT_OF_MEMORY, "nlopt_create failed", ""};

    Context context{monitor, opt.get(), row_.rejection};
    equations.context = inequalities.context = &context;
    nlopt_result code = nlopt_set_min_objective(opt.get(), objective, &context);
    const auto set = [&code](nlopt_result next) {
      if (code >= 0) code = next;
    };
    set(nlopt_set_lower_bounds(opt.get(), monitor.lower().data()));
    set(nlopt_set_upper_bounds(opt.get(), monitor.upper().data()));
    // Half the tolerance, so that what the solver takes for feasible is so for the judge as well.
    const auto tolerances = [&](const ConstraintContext& c) {
      return std::vector<double>(c.rows.size(), 0.5 * options.feasibility_tolerance);
    };
    if (!equations.rows.empty()) {
      set(nlopt_add_equality_mconstraint(opt.get(), static_cast<unsigned>(equations.rows.size()),
                                         constraints, &equations, tolerances(equations).data()));
    }
    if (!inequalities.rows.empty()) {
      set(nlopt_add_inequality_mconstraint(
          opt.get(), static_cast<unsigned>(inequalities.rows.size()), constraints, &inequalities,
          tolerances(inequalities).data()));
    }
    if (!options.library_defaults) set_tolerances(opt.get());

    const bool has_inner = wrapped || row_.algorithm == NLOPT_G_MLSL_LDS;
    const Opt lbfgs(has_inner ? nlopt_create(NLOPT_LD_LBFGS, n) : nullptr);
    const Opt inner(has_inner ? nlopt_create(row_.algorithm, n) : nullptr);
    if (has_inner && !options.library_defaults) {
      set_inner_tolerances(lbfgs.get());
      set_inner_tolerances(inner.get());
    }
    if (wrapped) {
      if (row_.algorithm == NLOPT_G_MLSL_LDS) nlopt_set_local_optimizer(inner.get(), lbfgs.get());
      // A global inner solver never ends by itself: without a cap the multipliers would stay zero.
      if (row_.global) nlopt_set_maxeval(inner.get(), std::max(100, options.max_evaluations / 20));
      set(nlopt_set_local_optimizer(opt.get(), inner.get()));
    } else if (row_.algorithm == NLOPT_G_MLSL_LDS) {
      set(nlopt_set_local_optimizer(opt.get(), lbfgs.get()));
    }

    const auto run = [&](Eigen::VectorXd x) {
      double f = 0.0;
      if (row_.stochastic) nlopt_srand(static_cast<unsigned long>(options.seed));
      code = nlopt_optimize(opt.get(), x.data(), &f);
    };
    context.is_watched = row_.algorithm == NLOPT_LD_SLSQP && !options.library_defaults;
    if (code >= 0) run(start);
    const bool is_off = context.watch.is_off(options.feasibility_tolerance);
    const bool goes_on = (context.watch.is_stuck() || is_off) && !monitor.stopped();
    if (goes_on) {
      const double slope = monitor.best().gradient.norm();
      context.scale = std::min(1.0, kStuck.cautious_step / slope);
      context.watch.reset();
      nlopt_set_force_stop(opt.get(), 0);
      run(monitor.best_x());
      if (context.watch.is_stuck()) monitor.stop(StopReason::Stalled);
    }
    const char* text = nlopt_get_errmsg(opt.get());
    NativeOutcome outcome{code, nlopt_result_to_string(code), ""};
    if (text != nullptr) outcome.status += std::string(": ") + text;
    if (wrapped) outcome.remark = "wrapped in an augmented Lagrangian";
    if (goes_on) outcome.remark = kStuckRemark;
    return outcome;
  }

  const Row& row_;
};

}  // namespace

Optimizers nlopt_optimizers() {
  Optimizers out;
  for (const Row& row : kTable) {
    if (is_compiled(row)) out.push_back(std::make_unique<NloptOptimizer>(row));
  }
  return out;
}

}  // namespace stillbase::nlp

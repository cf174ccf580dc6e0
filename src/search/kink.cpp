#include "search/kink.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillbase {

namespace {

/// A problem as one point sees it, with further pieces of its constraints behind them.
class WithPieces final : public nlp::Problem {
 public:
  WithPieces(const nlp::Problem& problem, const Eigen::VectorXd& x)
      : problem_(problem),
        x_(x),
        lower_(problem.constraint_lower()),
        upper_(problem.constraint_upper()) {
    problem.evaluate(x, here_);
    for (Eigen::Index i = 0; i < lower_.size(); ++i) row_of_.push_back(i);
  }

  int num_variables() const override { return problem_.num_variables(); }
  int num_constraints() const override { return static_cast<int>(row_of_.size()); }
  Eigen::VectorXd lower() const override { return problem_.lower(); }
  Eigen::VectorXd upper() const override { return problem_.upper(); }
  Eigen::VectorXd constraint_lower() const override { return lower_; }
  Eigen::VectorXd constraint_upper() const override { return upper_; }
  double objective_scale() const override { return problem_.objective_scale(); }
  void evaluate(const Eigen::VectorXd&, nlp::Evaluation& out) const override { out = here_; }

  const nlp::Evaluation& here() const { return here_; }

  /// Adds the pieces at x + step of the rows that are violated there by more than all known pieces
  /// foretell.
  /// @return whether there is any
  bool add_pieces_at(const Eigen::VectorXd& step, double difference) {
    nlp::Evaluation there;
    problem_.evaluate(x_ + step, there);
    const Eigen::VectorXd foretold = here_.constraints + here_.jacobian * step;
    const Eigen::Index rows = there.constraints.size();
    Eigen::VectorXd least = foretold.head(rows), largest = foretold.head(rows);
    for (std::size_t k = 0; k < row_of_.size(); ++k) {
      const auto piece = static_cast<Eigen::Index>(k);
      least[row_of_[k]] = std::min(least[row_of_[k]], foretold[piece]);
      largest[row_of_[k]] = std::max(largest[row_of_[k]], foretold[piece]);
    }
    bool is_new = false;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double value = there.constraints[i];
      const bool is_lower = value < std::min(lower_[i], least[i] - difference);
      const bool is_higher = value > std::max(upper_[i], largest[i] + difference);
      if (lower_[i] == upper_[i] || !(is_lower || is_higher)) continue;
      add(i, value - there.jacobian.row(i).dot(step), there.jacobian.row(i));
      is_new = true;
    }
    return is_new;
  }

 private:
  void add(Eigen::Index row, double value, const Eigen::RowVectorXd& gradient) {
    const auto rows = static_cast<Eigen::Index>(row_of_.size());
    row_of_.push_back(row);
    here_.constraints.conservativeResize(rows + 1);
    here_.constraints[rows] = value;
    here_.jacobian.conservativeResize(rows + 1, Eigen::NoChange);
    here_.jacobian.row(rows) = gradient;
    for (Eigen::VectorXd* bound : {&lower_, &upper_}) {
      bound->conservativeResize(rows + 1);
      (*bound)[rows] = (*bound)[row];
    }
  }

  const nlp::Problem& problem_;
  const Eigen::VectorXd x_;
  nlp::Evaluation here_;
  Eigen::VectorXd lower_, upper_;
  std::vector<Eigen::Index> row_of_;  ///< the problem's row that each one is a piece of
};

}  // namespace

bool is_stationary(const nlp::Problem& problem, const Eigen::VectorXd& x,
                   const KinkOptions& options) {
  WithPieces pieces(problem, x);
  const nlp::Evaluation& here = pieces.here();
  for (int probe = 0;; ++probe) {
    const nlp::Certificate found = nlp::certify(pieces, x, here);
    if (found.kkt_residual <= options.stationary) return true;
    if (probe == options.most_probes || !std::isfinite(found.kkt_residual)) return false;
    const Eigen::VectorXd residual =
        here.gradient + found.bound_multipliers + here.jacobian.transpose() * found.multipliers;
    const Eigen::VectorXd end = (x - options.probe / residual.norm() * residual)
                                    .cwiseMax(problem.lower())
                                    .cwiseMin(problem.upper());
    if (!pieces.add_pieces_at(end - x, options.other_slope * options.probe)) return false;
  }
}

}  // namespace stillbase

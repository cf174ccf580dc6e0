// A small strictly convex quadratic program, solved in place.
//
//   minimise 1/2 d' H d + g' d   subject to   n_i' d = b_i (equations), n_i' d >= b_i (the others)
//
// Source: Goldfarb and Idnani, "A numerically stable dual method for solving strictly convex
// quadratic programs", Mathematical Programming 27, 1983. From the unconstrained minimum the most
// violated row enters the active set until none is violated.
//
// Assumptions: numbers of order one; nothing is allocated after construction. Columns are kept with
// zeros up to a multiple of four numbers, so that no loop over them has a remainder.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace stillbase::nlp {

class DenseQp {
 public:
  DenseQp(int most_variables, int most_rows);

  /// Forgets all rows; H and g keep their entries.
  /// @param variables of this program, at most as many as at construction
  void begin(int variables);
  int variables() const { return n_; }
  int rows() const { return rows_; }
  /// H (n x n), positive definite, both triangles.
  auto hessian() { return H_.topLeftCorner(n_, n_); }
  auto gradient() { return g_.head(n_); }
  /// The normal of a further row, to be filled in. Equations come before all others.
  Eigen::Ref<Eigen::VectorXd> add_row(double b, bool is_equation = false);
  /// A further row sign * d_variable >= b, sign 1 or -1.
  void add_bound(int variable, double sign, double b);

  enum class Outcome {
    Solved,
    Inconsistent,  ///< no point satisfies the rows
    NotConvex      ///< H is not positive definite, or a number is not finite
  };
  [[nodiscard]] Outcome solve();

  // Of the last solve() that was Solved.
  auto solution() const { return d_.head(n_); }
  /// u with H d + g = sum u_i n_i, >= 0 but for equations; 0: the row is not active.
  auto multipliers() const { return multipliers_.head(rows_); }
  auto normal(int row) const { return normals_.col(row).head(n_); }

 private:
  int row(double b, bool is_equation);
  double slack(int row) const;
  double squared_normal(int row) const;
  bool factorise();
  /// J' n of a row, from that place on, and the step that leaves the active rows as they are.
  void project(int row, int from);
  /// The same but for the equations' part, and the change of the multipliers of the others.
  void find_step(int row);
  bool add_to_active(int row);
  void drop_from_active(int place);
  bool take_equations();
  void set_multipliers();
  int most_violated() const;

  int n_ = 0, padded_ = 0, rows_ = 0, equations_ = 0;
  Eigen::MatrixXd H_, normals_;  // one normal per column
  std::vector<int> bounded_;     // per row: the variable of a bound, else -1
  Eigen::VectorXd g_, b_, d_, multipliers_;
  // The active set: J' N = [R; 0], J J' = H^-1. The equations are its first rows, and what
  // inequalities have in their part is left out: it matters to their multipliers alone, which
  // follow in the end.
  Eigen::MatrixXd J_, R_;
  Eigen::VectorXd projected_;  // J' n of the row that find_step() was asked for
  Eigen::VectorXd step_, dual_step_, u_, work_;
  double curvature_ = 0;  // step' n
  std::vector<int> active_;
  std::vector<char> is_active_;
  int size_ = 0, kept_ = 0;  ///< active rows, and how many of them are equations
  double largest_pivot_ = 1;
};

}  // namespace stillbase::nlp

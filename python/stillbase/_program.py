"""The capture problem as a nonlinear program for other optimizers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._stillbase import Configuration, Evaluation, Formulation, Problem


class NonlinearProgram:
    """Minimise f(x) subject to g_l <= g(x) <= g_u and l <= x <= u.

    x has N entries: the free joints (rad, m), the rotation of the base (angle about its axis, or a
    rotation vector, rad), the contact time (s), as far as they are free. f = 1/2 |y|^2 with y the
    objective's quantities over their typical sizes; g are the m constraints, of order one.

    pygmo takes the object as a user-defined problem: `pygmo.problem(NonlinearProgram(problem))`.
    scipy takes its parts: `scipy.optimize.minimize(program.objective, program.start_point(),
    jac=program.objective_gradient, bounds=program.bounds, constraints=program.constraints)`.
    """

    def __init__(self, problem: Problem) -> None:
        """Raises InputError when fewer variables are free than there are equations."""
        self.problem = problem
        self._formulation = Formulation(problem)
        lower, upper = self._formulation.constraint_lower, self._formulation.constraint_upper
        self.equations: NDArray[np.intp] = np.flatnonzero(lower == upper)  #: indices into g
        # Every finite side of an inequality is a row h(x) <= 0: sign * g + offset.
        above = np.flatnonzero((lower != upper) & np.isfinite(upper))
        below = np.flatnonzero((lower != upper) & np.isfinite(lower))
        self._rows = np.concatenate((self.equations, above, below))
        self._signs: NDArray[np.float64] = np.concatenate(
            (np.ones(self.equations.size + above.size), -np.ones(below.size))
        )
        self._limits: NDArray[np.float64] = self._signs * np.concatenate(
            (upper[self.equations], upper[above], lower[below])
        )
        self._last: tuple[tuple[tuple[int, ...], bytes], Evaluation] | None = None

    def __getstate__(self) -> Problem:
        return self.problem

    def __setstate__(self, problem: Problem) -> None:
        self.__init__(problem)  # type: ignore[misc]

    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower bounds of the variables, (N,)."""
        return self._formulation.lower

    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper bounds of the variables, (N,)."""
        return self._formulation.upper

    @property
    def constraint_lower(self) -> NDArray[np.float64]:
        """Lower bounds of g, (m,); equal to the upper ones for equations."""
        return self._formulation.constraint_lower

    @property
    def constraint_upper(self) -> NDArray[np.float64]:
        """Upper bounds of g, (m,)."""
        return self._formulation.constraint_upper

    def evaluate(self, x: ArrayLike) -> Evaluation:
        """f, its gradient, g and its Jacobian at x (N,); the last point is remembered."""
        point = np.ascontiguousarray(x, dtype=np.float64)
        key = point.shape, point.tobytes()
        last = self._last
        if last is not None and last[0] == key:
            return last[1]
        evaluation = self._formulation.evaluate(point)
        self._last = (key, evaluation)
        return evaluation

    def start_point(self, u: ArrayLike | None = None) -> NDArray[np.float64]:
        """A start point (N,) for u in [0, 1)^N; without it the middle of the ranges."""
        size = self._formulation.lower.size
        return self._formulation.start_point(np.full(size, 0.5) if u is None else np.asarray(u))

    def configuration(self, x: ArrayLike) -> Configuration:
        """The configuration of the variables x (N,)."""
        return self._formulation.configuration(x)

    def variables(self, configuration: Configuration) -> NDArray[np.float64]:
        """The variables (N,) of a configuration. ValueError: it has another number of joints."""
        return self._formulation.variables(configuration)

    def value(self, x: ArrayLike) -> float:
        """The objective's quantity at x (N,), in its own unit.

        The nominal value, also where the measure of the plan is another, as a worst case.
        """
        return self._formulation.value_of(self.evaluate(x).objective)

    # scipy.optimize

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """(lower, upper) of each variable."""
        return list(zip(self.lower.tolist(), self.upper.tolist()))

    def objective(self, x: ArrayLike) -> float:
        """f at x (N,)."""
        return self.evaluate(x).objective

    def objective_gradient(self, x: ArrayLike) -> NDArray[np.float64]:
        """df/dx at x (N,), (N,)."""
        return self.evaluate(x).gradient

    @property
    def constraints(self) -> list[dict[str, Any]]:
        """The constraints as `scipy.optimize.minimize` takes them: fun = 0, and fun >= 0."""
        equations = self.equations.size
        parts = (("eq", slice(0, equations)), ("ineq", slice(equations, None)))
        return [
            {
                "type": kind,
                # Of an inequality scipy wants the positive side.
                "fun": lambda x, part=part: -self._constraint_rows(x)[part],
                "jac": lambda x, part=part: -self._constraint_jacobian(x)[part],
            }
            for kind, part in parts
            if self._rows[part].size > 0
        ]

    def _constraint_rows(self, x: ArrayLike) -> NDArray[np.float64]:
        rows: NDArray[np.float64] = self.evaluate(x).constraints[self._rows]
        return self._signs * rows - self._limits

    def _constraint_jacobian(self, x: ArrayLike) -> NDArray[np.float64]:
        rows: NDArray[np.float64] = self.evaluate(x).jacobian[self._rows]
        return self._signs[:, np.newaxis] * rows

    # pygmo

    def fitness(self, x: ArrayLike) -> NDArray[np.float64]:
        """[f, equations = 0, inequalities <= 0] at x (N,)."""
        return np.concatenate((np.array([self.objective(x)]), self._constraint_rows(x)))

    def gradient(self, x: ArrayLike) -> NDArray[np.float64]:
        """Derivatives of fitness(), row by row: (N * (1 + get_nec() + get_nic()),)."""
        rows = np.vstack((self.objective_gradient(x), self._constraint_jacobian(x)))
        return rows.ravel()

    def get_bounds(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Bounds of the variables, each (N,)."""
        return self.lower, self.upper

    def get_nec(self) -> int:
        """Number of equations."""
        return int(self.equations.size)

    def get_nic(self) -> int:
        """Number of inequalities."""
        return int(self._rows.size - self.equations.size)

    def get_name(self) -> str:
        """Name of the problem."""
        return self.problem.name

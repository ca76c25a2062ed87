"""Plans around boxes: found or not, how long they take and last, beside other planners."""

import importlib.util
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import islice, pairwise

import numpy as np

from benchmarks.harness import Row, median, percentile_95, share
from benchmarks.motion_peers import (
    Path,
    PathProblem,
    fastest_without_jerk_s,
    path_problem,
    planners,
)
from benchmarks.motion_problems import Problem, pick_problems
from robots.interfaces import Arm, Floats, MotionFailure, Trajectory
from robots.motion.planner import PlannerSettings
from robots.motion.verify import sample

PATH_SAMPLED_S = 0.01


def plans(name: str, seed: int, arms: Sequence[Arm] | None, count: int, goal: str) -> Iterator[Row]:
    """Plan motions whose straight way is blocked; then let all planners look for that way.

    Args:
        name: Begins the rows' names: how many joints move.
        seed: Of the problems.
        arms: Arms that move at once; None for one of both in turn.
        count: Problems.
        goal: Share of them that must be solved.
    """
    ways = list(islice(_blocked(seed, arms), count))
    yield from _whole(name, [way.problem for way in ways], goal)
    for peer, make in planners().items():
        yield from _searches(f"path_{name}_{peer}", ways, make)


def _blocked(seed: int, arms: Sequence[Arm] | None) -> Iterator[PathProblem]:
    for problem in pick_problems(seed, arms):
        way = path_problem(problem)
        if way is not None:
            yield way


def _whole(name: str, problems: Sequence[Problem], goal: str) -> Iterator[Row]:
    """Plan from goal to trajectory, with and without cutting corners on the same path."""
    times_ms, ratios, bounds, found = [], [], [], 0
    for problem in problems:
        planner = problem.planner()
        began = time.thread_time()
        trajectory = planner.to_goals(problem.start_rad, problem.goals)
        times_ms.append(1e3 * (time.thread_time() - began))
        if isinstance(trajectory, MotionFailure):
            continue
        found += 1
        stops = _with_stops(problem)
        if stops is not None:
            ratios.append(trajectory.duration_s / stops.duration_s)
        if importlib.util.find_spec("toppra"):
            limits = planner.limits
            rows = sample(trajectory, PATH_SAMPLED_S)[1]
            least_s = fastest_without_jerk_s(rows, limits.velocity, limits.acceleration)
            bounds.append(trajectory.duration_s / least_s)
    yield share(f"plan_{name}_found", found, len(problems), goal)
    yield median(f"plan_{name}_time", times_ms, "ms")
    yield percentile_95(f"plan_{name}_time_95", times_ms, "ms")
    if ratios:
        yield median(f"plan_{name}_duration_ratio", ratios, "1", "<= 0.72")
    if bounds:
        yield median(f"plan_{name}_over_bound_without_jerk", bounds, "1")


def _with_stops(problem: Problem) -> Trajectory | None:
    """Return the motion that rests at each waypoint of the same path; None without corners."""
    planner = problem.planner()
    planner.settings = PlannerSettings(corner_tries=0)
    stops = planner.to_goals(problem.start_rad, problem.goals)
    pieces = getattr(stops, "pieces", ())
    return None if isinstance(stops, MotionFailure) or len(pieces) < 2 else stops


def _searches(
    name: str, ways: Sequence[PathProblem], make: Callable[[PathProblem], Callable[[], Path]]
) -> Iterator[Row]:
    """Let one planner look for the ways."""
    times_ms, lengths, found = [], [], 0
    for way in ways:
        search = make(way)
        began = time.thread_time()
        path = search()
        times_ms.append(1e3 * (time.thread_time() - began))
        if path is not None and way.accepts(path):
            found += 1
            lengths.append(_length(path))
    yield share(f"{name}_found", found, len(ways))
    yield median(f"{name}_time", times_ms, "ms")
    yield percentile_95(f"{name}_time_95", times_ms, "ms")
    if lengths:
        yield median(f"{name}_length", lengths, "rad")


def _length(path: Sequence[Floats]) -> float:
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(path)))

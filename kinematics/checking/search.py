"""The search for the slips that explain an answer: one alone, then every pair.

What is tried: slips in the numbers (a situation), in what is computed of them (a reading of the
motion), and in how the result is written (a comparison). All slips of one stage are computed at
once. The effort is bounded by the number of link matrices, so that the same answer always gets the
same diagnosis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kinematics.checking.situation import Motion, Situation, Structure, evaluate
from kinematics.checking.slips import SituationSlip, Slip
from kinematics.deadline import checkpoint
from robots.robot import FloatArray

MAX_LINKS = 60_000
"""Link matrices that are computed for pairs of slips."""
CHUNK_LINKS = 12_000
CHANCE = 0.05
"""Wrong explanations that may fit by chance."""
MOST_SHOWN = 4
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class Reading:
    """What is computed of a motion.

    Attributes:
        slips: The slips in it; none for what was asked.
        values: Gives the values, shape (N, P, …).
    """

    slips: tuple[Slip, ...]
    values: Callable[[Motion], FloatArray]


@dataclass(frozen=True, eq=False)
class Comparison:
    """How values are held against the answer.

    Attributes:
        slips: The slips in how the answer is written; none for the right way.
        distance: Largest difference of each situation, shape (N, P, …) -> (N,).
    """

    slips: tuple[Slip, ...]
    distance: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class Explanation:
    """Slips that together give the answer.

    Attributes:
        slips: One or two.
        distance: Largest difference that is left.
    """

    slips: tuple[Slip, ...]
    distance: float

    @property
    def cost(self) -> float:
        """Return how unlikely the slips are."""
        return sum(slip.cost for slip in self.slips)


@dataclass(frozen=True, eq=False)
class Trial:
    """An answer, and everything that may have happened to it.

    Attributes:
        structure: The chain.
        situation: The right numbers.
        slips: Slips in them.
        readings: What was asked, first, and what may have been computed instead.
        comparisons: The right one first.
        thresholds: Differences up to which an explanation fits, the closest first.
        entries: Number of values that are independent of each other.
    """

    structure: Structure
    situation: Situation
    slips: Sequence[SituationSlip]
    readings: Sequence[Reading]
    comparisons: Sequence[Comparison]
    thresholds: Sequence[float]
    entries: int


def explanations(trial: Trial) -> list[Explanation]:
    """Return the best explanations of an answer, the likeliest first; empty where none fits.

    Explanations by one slip come before those by two, and those that meet the answer closely
    before those that meet it within a coarse tolerance. All that fit equally well are given.
    """
    single = list(_with_one_situation_slip(trial))
    pairs: list[Explanation] | None = None
    for threshold in trial.thresholds:
        ones = [found for found in single if len(found.slips) == 1]
        fitting = [one for one in ones if one.distance <= threshold]
        if fitting and _is_telling(threshold, ones, fitting, trial.entries):
            return _best(fitting)
        if pairs is None:
            pairs = [found for found in single if len(found.slips) == 2]
            pairs += _with_two_situation_slips(trial)
        fitting = [one for one in pairs if one.distance <= threshold]
        if fitting and _is_telling(threshold, pairs, fitting, trial.entries):
            return _best(fitting)
    return []


def _is_telling(
    threshold: float, tried: Sequence[Explanation], fitting: Sequence[Explanation], entries: int
) -> bool:
    """Return whether it is improbable that an explanation as likely as these fits by chance."""
    likeliest = min(one.cost for one in fitting)
    count = sum(one.cost <= likeliest for one in tried)
    return count * (2.0 * threshold) ** min(entries, 8) <= CHANCE


def _best(found: Sequence[Explanation]) -> list[Explanation]:
    ordered = sorted(found, key=lambda one: (round(one.cost, 6), one.distance))
    kept: list[Explanation] = []
    seen = set()
    for one in ordered:
        key = frozenset((slip.code, slip.where) for slip in one.slips)
        if key not in seen:
            seen.add(key)
            kept.append(one)
    return kept[:MOST_SHOWN]


def _with_one_situation_slip(trial: Trial) -> Iterator[Explanation]:
    """Yield all explanations with at most one slip in the numbers."""
    # Two slips in reading and comparison leave no room for one in the numbers.
    yield from _tried(trial, [trial.situation], [()], 2)
    size = max(1, CHUNK_LINKS // _links(trial))
    for start in range(0, len(trial.slips), size):
        checkpoint()
        part = trial.slips[start : start + size]
        situations = [one.apply(trial.situation) for one in part]
        yield from _tried(trial, situations, [(one.slip,) for one in part], 1)


def _tried(
    trial: Trial, situations: Sequence[Situation], own: Sequence[tuple[Slip, ...]], most: int
) -> Iterator[Explanation]:
    """Yield explanations of situations with at most so many slips beside their own."""
    motion = evaluate(trial.structure, situations)
    for reading in trial.readings:
        if len(reading.slips) > most:
            continue
        values = reading.values(motion)
        for comparison in trial.comparisons:
            others = (*reading.slips, *comparison.slips)
            if len(others) > most:
                continue
            for slips, distance in zip(own, comparison.distance(values), strict=True):
                if slips or others:
                    yield Explanation((*slips, *others), float(distance))


def _with_two_situation_slips(trial: Trial) -> list[Explanation]:
    found: list[Explanation] = []
    links = _links(trial)
    pairs = sorted(
        combinations(trial.slips, 2), key=lambda pair: pair[0].slip.cost + pair[1].slip.cost
    )
    pairs = pairs[: MAX_LINKS // links]
    size = max(1, CHUNK_LINKS // links)
    changed = {id(one): one.apply(trial.situation) for one in trial.slips}
    for start in range(0, len(pairs), size):
        checkpoint()
        part = pairs[start : start + size]
        situations = [second.apply(changed[id(first)]) for first, second in part]
        values = trial.readings[0].values(evaluate(trial.structure, situations))
        distances = trial.comparisons[0].distance(values)
        for (first, second), distance in zip(part, distances, strict=True):
            found.append(Explanation((first.slip, second.slip), float(distance)))
    return found


def _links(trial: Trial) -> int:
    return max(1, trial.structure.count) * len(trial.situation.q)


def to_given(given: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return the distance to given numbers, shape (P, …): the largest, relative to those over 1."""
    weight = np.maximum(1.0, np.abs(given))

    def distance(values: FloatArray) -> FloatArray:
        with np.errstate(invalid="ignore", over="ignore"):
            away = (np.abs(values - given) / weight).reshape(len(values), -1).max(axis=1)
        return np.where(np.isfinite(away), away, np.inf)

    return distance


def independent(values: FloatArray) -> int:
    """Return how many numbers of an array tell something: distinct sizes other than 0 and 1."""
    sizes = {round(abs(float(one)), 7) for one in np.ravel(values) if np.isfinite(one)}
    return max(1, len(sizes - {0.0, 1.0}))

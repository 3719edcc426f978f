"""Progress of a mural: what is planned of it so far, as it is shown, and kept to go on from."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from maulstick.errors import InputError
from maulstick.planning.mural.window import Watch
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State

_WHOLE, _ALL = "whole", "all"  # parts of a state: the plan of the whole in the making; all strokes of the mural
_WINDOW, _PLANNED = "window-", "planned-"  # and windows of the round, each with its index: in the making; planned


class MuralProgress:
    """What is planned of a mural, and what is in work.

    all: all strokes on the sheet when the present round began, None before the whole is planned.  finished: which of
    them lie in the cores of windows that are done, and stay, (N,).  done: indices of windows of earlier rounds.
    planned: of those of the present round.  wanted: whether to go on.
    """

    def __init__(self, windows: int, watch: Watch, resume: State | None) -> None:
        """Begin, or go on from a state that `PlanProgress.state` gave. Raises InputError for that of another plan."""
        self.all: PlanResult | None = None
        self.finished, self.wanted = torch.zeros(0, dtype=torch.bool), True
        self.done: set[int] = set()
        self.planned: dict[int, PlanResult] = {}
        self._stages, self._watch = windows + 1, watch
        self._shares: dict[str, float] = {}  # that are done of what is in work, by its part of a state
        self._states: dict[str, Callable[[], State]] = {}  # of what is in work, by its part of a state
        if resume is not None:
            try:
                self._restore(resume)
            except (KeyError, TypeError, ValueError, RuntimeError) as error:
                raise InputError("what there is to go on from is no plan of the same request; plan anew") from error

    def watch_whole(self, progress: PlanProgress) -> bool:
        """Take the progress of the whole, and return whether to go on."""
        return self._watch_part(_WHOLE, progress)

    def watch_window(self, index: int, progress: PlanProgress) -> bool:
        """Take the progress of a window, and return whether to go on."""
        return self._watch_part(f"{_WINDOW}{index}", progress)

    def state_of_whole(self) -> State | None:
        """Return the plan of the whole in the making, or None."""
        return self._state_of(_WHOLE)

    def state_of_window(self, index: int) -> State | None:
        """Return the plan of a window in the making, or None."""
        return self._state_of(f"{_WINDOW}{index}")

    def begin(self, planned: PlanResult) -> None:
        """Take the plan of the whole."""
        self.end_round(planned, torch.zeros(len(planned.paint_of), dtype=torch.bool), set())

    def keep(self, index: int, planned: PlanResult) -> None:
        """Take the plan of a window of the present round, its strokes on the sheet."""
        self.planned[index] = planned
        for in_work in (self._shares, self._states):
            in_work.pop(f"{_WINDOW}{index}", None)

    def end_round(self, planned: PlanResult, finished: Tensor, done: set[int]) -> None:
        """Take all strokes as they are after a round."""
        self.all, self.finished, self.done = planned, finished, done
        for of_the_round in (self.planned, self._shares, self._states):
            of_the_round.clear()

    def _watch_part(self, part: str, progress: PlanProgress) -> bool:
        self._shares[part], self._states[part] = progress.done, progress.state
        stages = (self.all is not None) + len(self.done) + len(self.planned) + sum(self._shares.values())
        self.wanted = self._watch(replace(progress, done=stages / self._stages, state=self._state)) and self.wanted
        return self.wanted

    def _state_of(self, part: str) -> State | None:
        return self._states[part]() if part in self._states else None

    def _state(self) -> State:
        """Return all that planning needs to go on from here, with as much of each window in work as it told last."""
        state = {f"{part}.{name}": array for part, of in self._states.items() for name, array in of().items()}
        if self.all is None:
            return state
        for index, planned in self.planned.items():
            state |= _as_state(f"{_PLANNED}{index}", planned)
        done = np.array(sorted(self.done), dtype=np.int64)
        return {**state, **_as_state(_ALL, self.all), "finished": self.finished.byte().numpy(), "windows_done": done}

    def _restore(self, state: State) -> None:
        parts: dict[str, State] = {}
        for name, array in state.items():
            part, _, rest = name.partition(".")
            parts.setdefault(part, {})[rest] = array
        if _ALL in parts:
            self.all, self.finished = _as_result(parts[_ALL]), torch.from_numpy(state["finished"]).bool()
            self.done = set(state["windows_done"].tolist())
        for part, of in parts.items():
            if part.startswith(_PLANNED):
                self.planned[int(part.removeprefix(_PLANNED))] = _as_result(of)
            elif part.startswith((_WHOLE, _WINDOW)):
                self._states[part] = of.copy


def _as_state(part: str, planned: PlanResult) -> State:
    tensors = {**planned.strokes.each(), "paints": planned.paints, "paint_of": planned.paint_of}
    return {f"{part}.{name}": tensor.numpy() for name, tensor in tensors.items()}


def _as_result(state: State) -> PlanResult:
    tensors = {name: torch.from_numpy(array) for name, array in state.items()}
    paints, paint_of = tensors.pop("paints"), tensors.pop("paint_of")
    return PlanResult(StrokeParameters(**tensors), paints, paint_of)

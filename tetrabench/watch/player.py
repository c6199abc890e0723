"""A simulation as a person plays it: step by step or running, with other options, in another structure, near or far."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from tetrabench.collision.simulation import Simulation
from tetrabench.collision.start.files import read_objects
from tetrabench.watch.opening import with_option
from tetrabench.watch.scene import Scene, make_scene, picture_size, whole_view

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from tetrabench.collision.contestant import CollisionContestant

USUAL_GRAVITY = 0.1  # the source's
MANY = 20_000  # objects: no structure that tests all pairs is offered then
FRAMES = 30  # that phases are averaged over
MOST_STEPS = 1024  # a frame
LARGEST = 150.0  # pixels: the radius of the largest object at the nearest
GAP = "     "  # between words of a line

KEYS = {
    "space": ("pause, or go on", "pause"),
    "right": ("one step", "step"),
    "s": ("one step", "step"),
    "up": ("twice as many steps a frame", "hasten"),
    "down": ("half as many steps a frame", "slow"),
    "r": ("recycling of leaves on or off", "recycle"),
    "g": ("gravity on or off", "gravitate"),
    "+": ("larger leaves", "enlarge"),
    "-": ("smaller leaves", "reduce"),
    "b": ("the next backend", "turn"),
    "l": ("borders of leaves on or off", "border"),
    "f": ("the whole box; the mouse wheel zooms, dragging moves", "see_whole"),
    "h": ("this help on or off", "help"),
    "q": ("quit", "quit"),
    "escape": ("quit", "quit"),
}


class Player:
    """Plays a simulation, a frame at a time.

    Attributes:
        simulation: what is played.
        contestants: what it can go on in, by name, with the options that they would have.
        limit: it is over after so many steps; None: never.
        has_keys: whether they are written above the box.
        view: what is seen.
        is_paused: steps are taken one by one.
        steps_a_frame: while it runs.
        has_leaves: whether the borders of leaves are shown; has_help: all keys.
        note: what came of the last key, in words.
    """

    def __init__(
        self,
        simulation: Simulation,
        contestants: Mapping[str, CollisionContestant],
        *,
        limit: int | None = None,
        has_keys: bool = True,
    ) -> None:
        self.simulation = simulation
        self.contestants = dict(contestants)
        self.limit = limit
        self.has_keys = has_keys
        self.is_paused = False
        self.has_leaves = True
        self.has_help = False
        self.steps_a_frame = 1
        self.note = ""
        self._single = 0  # steps that were asked for one by one
        self._wanted: CollisionContestant | None = None  # what to turn to after the next frame
        self._gravity = simulation.gravity or USUAL_GRAVITY
        self._is_quit = False
        self._marks: deque[tuple[int, dict[str, float]]] = deque(maxlen=FRAMES + 1)
        self._mark()
        self._whole = whole_view(simulation.start, *picture_size(simulation.start, self.rows), self.rows)
        self.view = self._whole

    @property
    def rows(self) -> int:
        """Lines of words above the box."""
        return 3 if self.has_keys else 2

    @property
    def is_over(self) -> bool:
        """Whether it was quit, or has played all steps."""
        return self._is_quit or (self.limit is not None and self.simulation.steps_done >= self.limit)

    def press(self, key: str) -> None:
        """Do what a key of KEYS stands for; of others, nothing."""
        if key in KEYS:
            self.note = ""
            getattr(self, KEYS[key][1])()

    def advance(self) -> None:
        """Go on to the next frame."""
        if self._wanted is not None:
            self.simulation.rebuild(self._wanted)
            self._wanted, self.note = None, ""
            self._marks.clear()
            self._mark()
        steps = self._single or (0 if self.is_paused else self.steps_a_frame)
        self._single = 0
        if self.limit is not None:
            steps = min(steps, self.limit - self.simulation.steps_done)
        if steps > 0:
            self.simulation.step(steps)
            self._mark()

    def scene(self, frames_a_second: float | None = None) -> Scene:
        """What is to be seen now."""
        contacts = self.simulation.find_pairs()
        lines = [self._facts(len(contacts)), self._times(frames_a_second)]
        if self.has_keys:
            lines.append(self._keys())
        if self.has_help:
            lines += [f"{key}:  {words}" for key, (words, _) in KEYS.items()]
        return make_scene(self.simulation, self.view, contacts, tuple(lines), has_leaves=self.has_leaves)

    # What keys do.

    def pause(self) -> None:
        """Stop, or go on."""
        self.is_paused = not self.is_paused

    def step(self) -> None:
        """Stop, one step on."""
        self.is_paused = True
        self._single += 1

    def hasten(self) -> None:
        """Twice as many steps a frame."""
        self.steps_a_frame = min(2 * self.steps_a_frame, MOST_STEPS)

    def slow(self) -> None:
        """Half as many."""
        self.steps_a_frame = max(self.steps_a_frame // 2, 1)

    def gravitate(self) -> None:
        """Gravity on or off."""
        if self.simulation.gravity:
            self._gravity = self.simulation.gravity
        self.simulation.gravity = 0.0 if self.simulation.gravity else self._gravity

    def recycle(self) -> None:
        """Recycling on or off."""
        self._choose("recycle", lambda value: 1 - value, "does not recycle leaves")

    def enlarge(self) -> None:
        """One more object in a leaf."""
        self._choose("capacity", lambda value: value + 1, "has no capacity")

    def reduce(self) -> None:
        """One less."""
        self._choose("capacity", lambda value: value - 1, "has no capacity")

    def turn(self) -> None:
        """Go on in the next structure, with the options that it had last."""
        count, now = len(self.simulation), self.contestant
        offered = [one for one in self.contestants.values() if not one.is_quadratic or count <= MANY or one is now]
        self._turn_to(offered[(offered.index(now) + 1) % len(offered)])

    def border(self) -> None:
        """Borders of leaves on or off."""
        self.has_leaves = not self.has_leaves
        if self.has_leaves and not len(self.simulation.leaf_rectangles()):
            self.note = f"{self.simulation.contestant.name} has no leaves"

    def see_whole(self) -> None:
        """Zoom out to the whole box."""
        self.view = self._whole

    def help(self) -> None:
        """All keys, on or off."""
        self.has_help = not self.has_help

    def quit(self) -> None:
        """End."""
        self._is_quit = True

    # What the mouse and the window do.

    def zoom(self, factor: float, across: float, down: float) -> None:
        """Come nearer to what lies at a pixel, within reason."""
        radius = float(self.simulation.objects.r.max(initial=1e-300))
        least = 0.5 * self._whole.scale
        scale = min(max(self.view.scale * factor, least), max(LARGEST / radius, self._whole.scale))
        self.view = self.view.zoomed(scale / self.view.scale, across, down)

    def shift(self, across: float, down: float) -> None:
        """Move what is seen by pixels."""
        self.view = self.view.shifted(across, down)

    def resize(self, width: int, height: int) -> None:
        """Fill a picture of another size: with the whole box if that was seen, else with the same place in the middle."""
        if (width, height) != (self.view.width, self.view.height):
            is_whole = self.view == self._whole
            self._whole = whole_view(self.simulation.start, width, height, self.rows)
            self.view = self._whole if is_whole else replace(self.view, width=width, height=height)

    # What it says.

    def _facts(self, contacts: int) -> str:
        """Step, objects, contacts, and what the structure counts."""
        simulation, contestant = self.simulation, self.simulation.contestant
        stats = simulation.stats()
        words = [
            f"step {simulation.steps_done:,}",
            _count(len(simulation), "object", "objects"),
            _count(contacts, "contact", "contacts"),
            contestant.name if contestant.is_exact else f"{contestant.name} (misses contacts)",
        ]
        if "leaves" in stats:
            words.append(_count(int(stats["leaves"]), "leaf", "leaves"))
        if "depth" in stats:
            words.append(f"depth {stats['depth']:,.0f}")
        if simulation.gravity:
            words.append(f"gravity {simulation.gravity:g}")
        return GAP.join(words)

    def _times(self, frames_a_second: float | None) -> str:
        """Of the phases and of the frames; and the note."""
        (first, before), (last, after) = self._marks[0], self._marks[-1]
        steps = max(last - first, 1)
        phases = (f"{name} {1e3 * (after[name] - before[name]) / steps:.2f}" for name in after)
        words = [f"a step, in ms:  {'  '.join(phases)}"]
        if frames_a_second is not None:
            words.append(f"{frames_a_second:.0f} frames a second")
        return GAP.join([*words, self.note] if self.note else words)

    def _keys(self) -> str:
        """The keys, with what they would change."""
        options = self.contestant.options
        words = ["space go on" if self.is_paused else "space pause", "s step"]
        if "recycle" in options:
            words.append(f"r recycling {'on' if options['recycle'].value else 'off'}")
        words.append(f"g gravity {'on' if self.simulation.gravity else 'off'}")
        if "capacity" in options:
            words.append(f"+ - capacity {options['capacity'].value}")
        words += ["b backend", "l borders", f"up down {_count(self.steps_a_frame, 'step', 'steps')} a frame"]
        return GAP.join([*words, "h help", "q quit"])

    # What it goes on in.

    @property
    def contestant(self) -> CollisionContestant:
        """What is played in, or what was asked for to go on in."""
        return self._wanted or self.simulation.contestant

    def _choose(self, name: str, change: Callable[[int], int], lack: str) -> None:
        """Change an option of the structure within its limits; or say that it has none such."""
        now = self.contestant
        if name not in now.options:
            self.note = f"{now.name} {lack}"
            return
        option = now.options[name]
        value = change(option.value)
        if option.least <= value <= option.most:
            self._turn_to(with_option(now, name, value))
        else:
            self.note = f"{name} {option.least} to {option.most}"

    def _turn_to(self, contestant: CollisionContestant) -> None:
        """Go on in it after the next frame: that may have to be compiled, and so the frame says so."""
        self.contestants[contestant.name] = self._wanted = contestant
        self.note = f"building {contestant.name} ..."

    def _mark(self) -> None:
        self._marks.append((self.simulation.steps_done, dict(self.simulation.phase_seconds)))


def open_player(
    path: Path,
    contestants: Mapping[str, CollisionContestant],
    backend: str,
    *,
    limit: int | None = None,
    has_keys: bool = True,
    **rules: Any,
) -> Player:
    """A player of the objects of a file, compiled.

    Args:
        path: of the objects.
        contestants: see `Player`.
        backend: which of them to begin with.
        limit, has_keys: see `Player`.
        rules: gravity, bounce and mode: see `Simulation`.

    Raises:
        InputError: the file holds no objects, or a rule is out of its range.
    """
    simulation = Simulation(read_objects(path), contestants[backend], **rules)
    simulation.step(0)
    return Player(simulation, contestants, limit=limit, has_keys=has_keys)


def _count(number: int, one: str, more: str) -> str:
    return f"{number:,} {one if number == 1 else more}"

"""The window: paints the scenes of a player with pygame, and hands it the keys."""

from __future__ import annotations

import os
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from tetrabench.errors import InputError
from tetrabench.watch.player import KEYS
from tetrabench.watch.scene import (
    BACKGROUND,
    BRIGHT,
    CONTACT,
    FLOOR,
    LEAF,
    LETTERS,
    LINE,
    OBJECT,
    OPACITY,
    QUIET,
    WALL,
)

if TYPE_CHECKING:
    from tetrabench.watch.player import Player
    from tetrabench.watch.scene import Scene

ZOOM = 1.15  # a notch of the mouse wheel
SAME_KEYS = {"=": "+", "_": "-"}  # where + wants shift, and - does not
REPEAT = 350, 60  # milliseconds: until a key that is held repeats, and then
FINE = 8.0  # pixels: smaller objects move by quarters of a pixel, as whole ones would be seen to jump
PARTS = 4  # of a pixel
KEPT = 4096  # sprites

BLIND = ("dummy", "offscreen")
"""Drivers of SDL that show nothing; it takes one of them where there is no screen."""


def check_window() -> None:
    """Whether there can be a window.

    Raises:
        InputError: pygame is not installed.
    """
    if find_spec("pygame") is None:
        raise InputError('a window needs pygame: pip install "tetrabench[watch]"; --record FILE.gif needs none')


def open_window(player: Player, *, frames_a_second: int = 60, title: str = "tetrabench watch") -> None:
    """Show a simulation until its player is over.

    Raises:
        InputError: pygame is not installed, or there is no screen.
    """
    check_window()
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")  # only the command line prints
    import pygame

    try:
        pygame.display.init()
        if pygame.display.get_driver() in BLIND and "SDL_VIDEODRIVER" not in os.environ:
            raise pygame.error("there is no screen")
        screen: Any = pygame.display.set_mode((player.view.width, player.view.height), pygame.RESIZABLE)
    except pygame.error as error:
        pygame.quit()
        raise InputError(f"no window can be opened ({error}); --record FILE.gif needs none") from error
    try:
        pygame.display.set_caption(title)
        pygame.key.set_repeat(*REPEAT)
        painter, clock = Painter(), pygame.time.Clock()
        while not player.is_over:
            player.resize(*screen.get_size())
            painter.paint(screen, player.scene(frames_a_second=clock.get_fps()))
            pygame.display.flip()
            for event in pygame.event.get():
                take(event, player)
            player.advance()
            clock.tick(frames_a_second)
    finally:
        pygame.quit()


def take(event: Any, player: Player) -> None:
    """Hand an event of pygame to the player."""
    import pygame

    if event.type == pygame.QUIT:
        player.press("q")
    elif event.type == pygame.KEYDOWN:
        player.press(_key(event))
    elif event.type == pygame.MOUSEWHEEL:
        player.zoom(ZOOM**event.y, *pygame.mouse.get_pos())
    elif event.type == pygame.MOUSEMOTION and event.buttons[0]:
        player.shift(*event.rel)


def _key(event: Any) -> str:
    """Its name in KEYS: what it types, else what it is called."""
    import pygame

    typed = event.unicode.lower()
    typed = SAME_KEYS.get(typed, typed)
    return typed if typed in KEYS else pygame.key.name(event.key).strip("[]")  # those of the number pad are in brackets


class Painter:
    """Paints scenes onto surfaces; keeps what takes long to paint and is there again in the next one."""

    def __init__(self) -> None:
        import matplotlib
        import pygame

        pygame.font.init()
        # The letters of the films, and on every machine there.
        self._font = pygame.font.Font(f"{matplotlib.get_data_path()}/fonts/ttf/DejaVuSans.ttf", LETTERS)
        self._sprites = Sprites()
        self._ground: Any = None
        self._ground_of: tuple[Any, ...] = ()

    def paint(self, surface: Any, scene: Scene) -> None:
        """Paint a scene onto a surface of its size."""
        surface.blit(self._painted_ground(scene), (0, 0))
        surface.fblits(self._objects(scene))
        if scene.bar:
            surface.fill(BACKGROUND, (0, 0, scene.width, scene.bar))
        for number, line in enumerate(scene.lines):
            words = self._font.render(line, True, QUIET if number else BRIGHT)
            surface.blit(words, (LETTERS, 6 + LINE * number + (LINE - words.get_height()) // 2))

    def _painted_ground(self, scene: Scene) -> Any:
        """What lies beneath the objects: the box and the borders of leaves; painted where it has changed."""
        import pygame

        is_same = (
            self._ground is not None
            and self._ground.get_size() == (scene.width, scene.height)
            and all(
                np.array_equal(old, new) for old, new in zip(self._ground_of, (scene.box, scene.leaves), strict=True)
            )
        )
        if not is_same:
            self._ground = ground = pygame.Surface((scene.width, scene.height)).convert()
            self._ground_of = scene.box, scene.leaves
            ground.fill(BACKGROUND)
            left, top, right, bottom = np.clip(np.rint(scene.box), -2, 32_000).astype(int).tolist()
            box = pygame.Rect(left, top, right - left + 1, bottom - top + 1)
            ground.fill(FLOOR, box)
            for left, top, right, bottom in scene.leaves.astype(int).tolist():
                pygame.draw.rect(ground, LEAF, (left, top, right - left + 1, bottom - top + 1), 1)
            pygame.draw.rect(ground, WALL, box, 1)
        return self._ground

    def _objects(self, scene: Scene) -> Any:
        """Sprites and where their upper left corners come."""
        if len(self._sprites) > KEPT:
            self._sprites.clear()
        quarters = np.rint(4 * scene.radii).astype(np.int64)
        half = np.ceil(quarters / 4 + 1).astype(np.int64)
        corners = np.floor(scene.places)
        parts = np.floor((scene.places - corners) * PARTS).astype(np.int64)
        parts[scene.radii >= FINE] = 0
        keys = ((quarters * 2 + scene.in_contact) * PARTS + parts[:, 0]) * PARTS + parts[:, 1]
        left, top = (corners.astype(np.int64) - half[:, None]).T.tolist()
        # Iterators down to the end: lists of so many pairs would set off the garbage collector in every frame.
        return zip(map(self._sprites.__getitem__, keys.tolist()), zip(left, top, strict=True), strict=True)


class Sprites(dict[int, Any]):
    """Small pictures of objects by number, made when they are asked for.

    The number is ((quarters of a pixel of the radius * 2 + in contact) * PARTS + parts of a pixel to the right) * PARTS +
    parts downward; the middle of the picture is the corner that those parts are counted from.
    """

    def __missing__(self, key: int) -> Any:
        import pygame

        rest, down = divmod(key, PARTS)
        rest, right = divmod(rest, PARTS)
        quarters, in_contact = divmod(rest, 2)
        radius, half = quarters / 4, int(np.ceil(quarters / 4 + 1))
        sprite = pygame.Surface((2 * half + 1, 2 * half + 1), pygame.SRCALPHA)
        sprite.fill(CONTACT if in_contact else OBJECT)
        middles = np.arange(2 * half + 1) + 0.5 - half  # of the pixels, from the corner
        across, under = middles - (right + 0.5) / PARTS, middles - (down + 0.5) / PARTS
        # Of a pixel at the rim, about the share that is inside.
        inside = np.clip(radius + 0.5 - np.hypot(across[:, None], under[None, :]), 0, 1)
        alpha = pygame.surfarray.pixels_alpha(sprite)
        alpha[...] = np.rint(255 * OPACITY * inside)
        del alpha  # else the sprite stays locked
        self[key] = sprite
        return sprite

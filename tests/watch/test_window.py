"""The window, driven by events that are posted; and its painter, pixel by pixel beside that of films."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.watch.made import make_player
from tetrabench.errors import InputError
from tetrabench.watch import film, window
from tetrabench.watch.player import Player
from tetrabench.watch.scene import BACKGROUND, Scene

pygame = pytest.importorskip("pygame")


@pytest.fixture(autouse=True)
def headless(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No screen is needed, and none used."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.quit()


def key(typed: str = "", code: int = 0) -> object:
    """A key that is pressed: by what it types, or by its code."""
    return pygame.event.Event(pygame.KEYDOWN, unicode=typed, key=code or (ord(typed) if typed else 0), mod=0)


class Driven:
    """A player whose frames are noted, and after each of which events are posted."""

    def __init__(self, player: Player, *events: object) -> None:
        self.player, self.events, self.states = player, list(events), []
        advance = player.advance

        def go_on() -> None:
            advance()
            self.states.append(self.state())
            assert len(self.states) < 100, "it never ends"
            pygame.event.post(self.events.pop(0) if self.events else pygame.event.Event(pygame.QUIT))

        player.advance = go_on  # type: ignore[method-assign]
        window.open_window(player, frames_a_second=1000)

    def state(self) -> tuple[object, ...]:
        """Steps, structure and its options, gravity."""
        simulation = self.player.simulation
        values = {name: option.value for name, option in simulation.contestant.options.items()}
        return simulation.steps_done, simulation.contestant.name, values, simulation.gravity


def test_keys_do_what_they_say(rng: np.random.Generator) -> None:
    player = make_player(rng)
    driven = Driven(
        player,
        key(" ", pygame.K_SPACE),  # 1: it stops
        key("s"),  # 2: a step
        key("", pygame.K_RIGHT),  # 3: and another
        key("r"),  # 4
        key("+"),  # 5
        key("="),  # 6: + on some keyboards, without shift
        key("", pygame.K_KP_PLUS),  # 7: on the number pad
        key("-"),  # 8
        key("G"),  # 9
        key("b"),  # 10
        key("l"),  # 11
        key("h"),  # 12
        key("", pygame.K_UP),  # 13
        key(" ", pygame.K_SPACE),  # 14: on, two at once
        key("", pygame.K_DOWN),  # 15: one at once
        key("é"),  # 16: nothing
        key("q"),  # the last, with which there is a step
    )
    steps, names, values, gravity = zip(*driven.states, strict=True)
    assert steps == (1, 1, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 5, 6, 7, 8)
    assert names == ("kdtree",) * 10 + ("grid",) * 8
    capacity = values[0]["capacity"]
    assert [value["recycle"] for value in values[:10]] == [1] * 4 + [0] * 6
    assert [value["capacity"] - capacity for value in values[:10]] == [0] * 5 + [1, 2, 3, 2, 2]
    assert gravity == (0.0,) * 9 + (0.1,) * 9
    assert not player.has_leaves
    assert player.has_help


@pytest.mark.parametrize("how", ["q", "escape", "close"])
def test_it_ends(rng: np.random.Generator, how: str) -> None:
    events = {"q": key("q"), "escape": key("\x1b", pygame.K_ESCAPE), "close": pygame.event.Event(pygame.QUIT)}
    driven = Driven(make_player(rng), events[how], key("b"))
    assert len(driven.states) == 2
    assert driven.player.is_over
    assert not pygame.display.get_init()


def test_it_ends_after_so_many_steps(rng: np.random.Generator) -> None:
    player = make_player(rng)
    player.limit = 4
    window.open_window(player, frames_a_second=1000)
    assert player.simulation.steps_done == 4


def test_the_mouse_zooms_and_drags(rng: np.random.Generator) -> None:
    player = make_player(rng)
    whole = player.view
    wheel = pygame.event.Event(pygame.MOUSEWHEEL, x=0, y=3)
    drag = pygame.event.Event(pygame.MOUSEMOTION, pos=(5, 5), rel=(12, -7), buttons=(1, 0, 0))
    passing = pygame.event.Event(pygame.MOUSEMOTION, pos=(5, 5), rel=(100, 100), buttons=(0, 0, 0))
    Driven(player, wheel, drag, passing)
    near = whole.zoomed(window.ZOOM**3, 0.0, 0.0)  # where no mouse is, it is in the corner
    assert player.view == near.shifted(12, -7)


def test_errors_of_a_player_close_the_window(rng: np.random.Generator) -> None:
    player = make_player(rng)
    player.advance = lambda: 1 / 0  # type: ignore[method-assign, assignment, return-value]
    with pytest.raises(ZeroDivisionError):
        window.open_window(player)
    assert not pygame.display.get_init()


def test_no_pygame_and_no_screen_are_one_line_each(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "nonesuch")
    with pytest.raises(InputError, match=r"no window can be opened \(.*\); --record FILE.gif needs none"):
        window.open_window(make_player(rng))
    monkeypatch.setattr(window, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r'pip install "tetrabench\[watch\]"'):
        window.check_window()


def pixels_of(scene: Scene, painter: window.Painter | None = None) -> np.ndarray:
    """As the window paints it, (height, width, 3)."""
    pygame.display.init()
    surface = pygame.display.set_mode((scene.width, scene.height))
    (painter or window.Painter()).paint(surface, scene)
    return pygame.surfarray.array3d(surface).swapaxes(0, 1).astype(int)


@pytest.mark.parametrize("zoom", [0.6, 1.0, 3.0])
def test_both_painters_paint_the_same(rng: np.random.Generator, zoom: float) -> None:
    player = make_player(rng)
    player.advance()
    player.zoom(zoom, 400.0, 300.0)
    scene = player.scene()
    figure = film.make_figure(scene.width, scene.height)
    film.paint(figure, scene)
    there, here = film._pixels(figure).astype(int), pixels_of(scene)
    assert there.shape == here.shape
    box = here[scene.bar :], there[scene.bar :]
    differ = np.abs(box[0] - box[1]).max(axis=2) > 60  # rims of circles, borders a pixel aside
    assert differ.mean() < 0.01
    is_object = np.abs(box[0] - np.array(pygame.Color(BACKGROUND))[:3]).max(axis=2) > 120
    assert is_object.any()
    assert differ[is_object].mean() < 0.1


def test_what_was_painted_before_is_not_seen_again(rng: np.random.Generator) -> None:
    """The ground and the sprites are kept from scene to scene: as if they were not."""
    player = make_player(rng)
    pygame.display.init()
    pygame.display.set_mode((10, 10))
    painter = window.Painter()
    for keys in ("", "", "l", "l", "b", "", "-----------", "zoom", "f", "resize", ""):
        if keys == "zoom":
            player.zoom(2.5, 300.0, 300.0)
        elif keys == "resize":
            player.resize(700, 500)
        else:
            for one in keys:
                player.press(one)
        player.advance()
        scene = player.scene()
        np.testing.assert_array_equal(pixels_of(scene, painter), pixels_of(scene))
    assert len(painter._sprites) > 10


def test_sprites_are_as_large_as_circles_and_lie_where_they_are() -> None:
    sprites = window.Sprites()
    for quarters in (5, 9, 40, 200):
        for right in range(window.PARTS):
            for down in range(window.PARTS):
                number = (quarters * 2 * window.PARTS + right) * window.PARTS + down
                alpha = pygame.surfarray.array_alpha(sprites[number]).astype(float)
                half = len(alpha) // 2
                share = alpha / alpha.sum()
                middles = np.arange(len(alpha)) + 0.5 - half
                area = alpha.sum() / 255 / window.OPACITY
                assert area == pytest.approx(np.pi * (quarters / 4) ** 2, rel=0.08)
                assert share.sum(axis=1) @ middles == pytest.approx((right + 0.5) / window.PARTS, abs=0.05)
                assert share.sum(axis=0) @ middles == pytest.approx((down + 0.5) / window.PARTS, abs=0.05)


def test_sprites_are_forgotten_when_there_are_many(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(window, "KEPT", 20)
    player = make_player(rng)
    pygame.display.init()
    screen = pygame.display.set_mode((player.view.width, player.view.height))
    painter = window.Painter()
    player.zoom(0.5, 400.0, 400.0)  # small ones have many sprites
    for _ in range(6):
        player.advance()
        painter.paint(screen, player.scene())
    assert len(painter._sprites) <= 20 + len(player.simulation)


def test_large_objects_need_a_sprite_each(rng: np.random.Generator) -> None:
    player = make_player(rng, count=1)
    player.zoom(20.0, 400.0, 400.0)
    player.view = replace(player.view, x=0.0, y=0.0)
    painter = window.Painter()
    for place in np.linspace(0, 1, 9):
        player.simulation.objects.x[:] = player.simulation.objects.y[:] = place
        pixels_of(player.scene(), painter)
    assert len(painter._sprites) == 1

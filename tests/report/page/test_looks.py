"""How backends and models look: told apart without colour, and the same whoever else takes part."""

from itertools import combinations

import pytest

from tests.report.made import SECONDS, make_backend, make_results
from tetrabench import registry
from tetrabench.report.page.looks import PATHS, looks_of, shapes_of
from tetrabench.report.page.subjects import make_runs, make_subjects

SEVEN = tuple(SECONDS["init"])


def looks_among(*names):
    """The looks of some of the seven, in a run of their own."""
    results = make_results({"alfa": dict.fromkeys(names, 1.0)}, launches=1, rounds=1)
    return looks_of(make_subjects(make_runs([("run", results)])))


def test_no_two_of_the_seven_share_dash_and_shape():
    looks = looks_among(*SEVEN)
    assert tuple(looks) == SEVEN
    for one, other in combinations(looks.values(), 2):
        assert (one["dash"], one["shape"]) != (other["dash"], other["shape"])
        assert (one["fill"], one["stroke"]) != (other["fill"], other["stroke"])


@pytest.mark.parametrize("family", ["tetra", "polygon"])
def test_no_two_of_a_family_look_alike(family):
    backends = [make_backend(one.name, title=one.title) for one in registry.contestants(family)]
    results = make_results({"alfa": {"v3y": 1.0}}, backends=backends, titles=[one.title for one in backends])
    looks = looks_of(make_subjects(make_runs([("run", results)])))
    assert len(looks) >= 7
    for one, other in combinations(looks.values(), 2):
        assert (one["fill"], one["stroke"]) != (other["fill"], other["stroke"])
        assert (one["dash"], one["shape"]) != (other["dash"], other["shape"])


def test_a_dash_is_a_layout_and_a_shape_what_it_is_combined_with():
    looks = looks_among(*SEVEN)
    for part, cut in (("dash", 0), ("stroke", 0), ("shape", 1)):
        for one, other in combinations(looks.values(), 2):
            alike = one["title"].split(", ")[cut] == other["title"].split(", ")[cut]
            assert (one[part] == other[part]) == alike, (part, one["title"], other["title"])
    assert {look["shape"] for look in looks.values()} <= PATHS.keys()


def test_each_has_its_own_words():
    assert {name: look["title"] for name, look in looks_among(*SEVEN).items()} == {
        name: make_backend(name).title for name in SEVEN
    }


@pytest.mark.parametrize("names", [("v3y", "v4"), ("v5y", "v3y"), ("v5x", "v4", "v3y"), tuple(reversed(SEVEN))])
def test_looks_are_the_same_whoever_takes_part(names):
    all_, some = looks_among(*SEVEN), looks_among(*names)
    assert some == {name: all_[name] for name in names}


def test_looks_are_the_same_in_every_run_of_a_page():
    runs = [(one, make_results({"alfa": {"v3y": 1.0, one: 1.0}}, launches=1, rounds=1)) for one in ("v5", "v4", "v3x")]
    together = looks_of(make_subjects(make_runs(runs)))
    all_ = looks_among(*SEVEN)
    assert together == {name: all_[name] for name in ("v3y", "v5", "v4", "v3x")}


def test_no_two_of_eight_models_share_a_mark():
    labels = [f"model {place}" for place in range(8)]
    shapes = shapes_of(labels)
    assert [*shapes] == labels
    assert len(set(shapes.values())) == 8
    assert set(shapes.values()) == PATHS.keys()
    assert shapes_of(labels[:3]) == {label: shapes[label] for label in labels[:3]}
    assert len(shapes_of([*labels, "one more"])) == 9  # marks come again rather than none


def test_marks_of_a_legend_are_unlike():
    assert len(set(PATHS.values())) == len(PATHS)

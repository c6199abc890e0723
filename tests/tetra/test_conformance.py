"""Our own contestants keep to all rules of the family, and what is wrong with broken ones is found, and said in words."""

from pathlib import Path

import pytest

from tests.examined import first_sentences
from tests.tetra.broken import FAULTS
from tetrabench.backends.tetra import CONTESTANTS
from tetrabench.tetra.conformance import RULES

PLUGIN = Path(__file__).with_name("broken.py")
HALF = (
    "not implemented: centroid(net, t, k) of its layout, Broken, set_centroid(net, t, k, value) of its layout, Broken, "
    "grown_layout(net, capacity) of its layout, Broken"
)


@pytest.mark.parametrize("contestant", CONTESTANTS, ids=lambda contestant: contestant.name)
def test_ours_keep_to_all_rules(contestant):
    found = {rule.name: list(rule.faults(contestant)) for rule in RULES}
    assert any(found.values()) == (not contestant.is_exact), found


def test_what_is_broken_is_found_and_named(tmp_path):
    found = first_sentences("tetra", PLUGIN, [*FAULTS, "half"], tmp_path / "notes")
    assert [name for name in FAULTS if name not in found] == []
    assert {name: found[name] for name, (*_, named) in FAULTS.items() if named not in found[name]} == {}
    assert found["half"] == HALF

"""Element sets and their algebra beside naive twins: lists that several sets hold, and collections.Counter."""

import operator
import tracemalloc
from collections import Counter
from functools import reduce

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from tetrabench.backends.tetra.halfface import sets
from tetrabench.backends.tetra.halfface.block import LARGEST
from tetrabench.backends.tetra.halfface.handles import INVALID, Element
from tetrabench.backends.tetra.halfface.sets import ElementMultiset, ElementSet
from tetrabench.errors import InputError

VERTEX = Element.VERTEX
KINDS = [ElementSet, ElementMultiset]
HANDLE = st.one_of(st.integers(0, 12), st.integers(LARGEST - 3, LARGEST))
HANDLES = st.lists(HANDLE, max_size=12)
MANY = st.builds(lambda handles, times: (handles * times)[:2000], st.lists(HANDLE, max_size=40), st.integers(1, 60))
PICK = st.integers(0, 10**6)
OPERATORS = {
    operator.or_: lambda m, n: Counter({h: max(m[h], n[h]) for h in {*m, *n}}),
    operator.and_: lambda m, n: Counter({h: min(m[h], n[h]) for h in {*m, *n}}),
    operator.xor: lambda m, n: Counter({h: abs(m[h] - n[h]) for h in {*m, *n}}),
    operator.sub: lambda m, n: Counter({h: max(m[h] - n[h], 0) for h in {*m, *n}}),
}


class Twin:
    """A set or multiset the slow way; `data` is what it may share: a dict of two lists."""

    def __init__(self, multiple, data):
        self.multiple, self.data = multiple, data

    @property
    def elements(self):
        return sorted(self.data["committed"] if self.multiple else set(self.data["committed"]))


def kind_of(twin):
    return KINDS[twin.multiple]


def new_data(committed=(), tail=()):
    return {"committed": list(committed), "tail": list(tail)}


def check_answers(asked, counter):
    """All that can be asked of an operand, against how often it has each handle."""
    elements = sorted(counter.elements())
    assert list(asked) == elements
    assert asked.is_empty() == (not elements)
    assert bool(asked) == bool(elements)
    assert asked.any() == (elements[0] if elements else INVALID)
    for handle in [INVALID, *range(14), *range(LARGEST - 3, LARGEST + 2)]:
        assert (handle in asked) == asked.elem(handle) == (counter[handle] > 0)
        assert asked.count(handle) == counter[handle]


class Sharing(RuleBasedStateMachine):
    """Sets and multisets that share data, beside twins that share theirs."""

    @initialize(starts=st.lists(st.tuples(st.booleans(), HANDLES), min_size=3, max_size=5))
    def start(self, starts):
        self.twins = [Twin(multiple, new_data(handles)) for multiple, handles in starts]
        self.sets = [KINDS[multiple](VERTEX, handles) for multiple, handles in starts]

    def pick(self, number):
        return self.sets[number % len(self.sets)], self.twins[number % len(self.sets)]

    @rule(number=PICK, handle=HANDLE)
    def insert(self, number, handle):
        mine, twin = self.pick(number)
        mine.insert(np.int64(handle) if handle % 2 else handle)
        twin.data["tail"].append(handle)

    @rule(
        number=PICK, handles=HANDLES, form=st.sampled_from([list, iter, tuple, lambda all_: np.array(all_, np.uint64)])
    )
    def insert_range(self, number, handles, form):
        mine, twin = self.pick(number)
        mine.insert_range(form(handles))
        twin.data["tail"].extend(handles)

    @rule(number=PICK, other=PICK)
    def insert_another(self, number, other):
        (mine, twin), (source, its) = self.pick(number), self.pick(other)
        mine.insert_range(source)
        twin.data["tail"].extend(its.elements)

    @rule(number=PICK, handles=HANDLES, wrong=st.sampled_from([-1, -2, 2**63, 1.0, True, None, "3", np.bool_(False)]))
    def insert_wrong(self, number, handles, wrong):
        mine, _ = self.pick(number)
        for refused in (lambda: mine.insert(wrong), lambda: mine.insert_range([*handles, wrong])):
            with pytest.raises(InputError):
                refused()

    @rule(number=PICK)
    def commit(self, number):
        mine, twin = self.pick(number)
        mine.commit()
        twin.data["committed"] += twin.data["tail"]
        twin.data["tail"].clear()

    @rule(number=PICK)
    def unique(self, number):
        mine, twin = self.pick(number)
        mine.unique()
        twin.data["committed"][:] = set(twin.data["committed"])

    @rule(number=PICK)
    def clear(self, number):
        mine, twin = self.pick(number)
        mine.clear()
        twin.data["committed"].clear()
        twin.data["tail"].clear()

    @rule(number=PICK)
    def isolate(self, number):
        mine, twin = self.pick(number)
        assert mine.isolate() is mine
        twin.data = new_data(**twin.data)

    @rule(number=PICK, other=PICK)
    def assign(self, number, other):
        (mine, twin), (source, its) = self.pick(number), self.pick(other)
        mine.assign(source)
        twin.data = its.data

    @rule(number=PICK, other=PICK)
    def swap(self, number, other):
        (mine, twin), (theirs, its) = self.pick(number), self.pick(other)
        mine.swap(theirs)
        twin.data, its.data = its.data, twin.data

    @rule(number=PICK, multiple=st.booleans())
    def convert(self, number, multiple):
        source, its = self.pick(number)
        place = number % len(self.sets)
        self.sets[place], self.twins[place] = KINDS[multiple](source), Twin(multiple, its.data)

    @rule(number=PICK, left=PICK, right=PICK, symbol=st.sampled_from(list(OPERATORS)), way=st.sampled_from("ace"))
    def combine(self, number, left, right, symbol, way):
        (a, one), (b, other) = self.pick(left), self.pick(right)
        result = OPERATORS[symbol](Counter(one.elements), Counter(other.elements))
        mine, twin = self.pick(number)
        expression = symbol(a, b)
        if way == "a":
            mine.assign(expression)
        elif way == "c":
            mine = kind_of(twin)(expression)
        else:
            mine = expression.evaluate()
            assert isinstance(mine, ElementMultiset) == (one.multiple or other.multiple)
            twin = Twin(isinstance(mine, ElementMultiset), None)
        elements = list(result.elements()) if twin.multiple else list(+result)
        self.sets[number % len(self.sets)] = mine
        self.twins[number % len(self.sets)] = Twin(twin.multiple, new_data(elements))

    @invariant()
    def all_alike(self):
        for mine, twin in zip(self.sets, self.twins, strict=True):
            assert isinstance(mine, kind_of(twin))
            committed, tail = twin.data["committed"], twin.data["tail"]
            assert (mine.size, len(mine), mine.committed_size) == (len(committed + tail),) * 2 + (len(committed),)
            assert mine.is_committed() == (not tail)
            assert mine.empty == (not committed)
            check_answers(mine, Counter(twin.elements))
            assert list(reversed(mine)) == twin.elements[::-1]
            assert mine.handles.tolist() == twin.elements
            assert (mine.handles.dtype, mine.handles.flags.writeable) == (np.int64, False)
        for mine, twin in zip(self.sets, self.twins, strict=True):
            for theirs, other in zip(self.sets, self.twins, strict=True):
                assert (mine == theirs) == (twin.elements == other.elements) != (mine != theirs)


TestSharing = Sharing.TestCase


@st.composite
def expressions(draw, handles=HANDLES):
    """A set, a multiset, or an expression of either, with how often it has what."""

    def leaf(multiple, handles):
        return KINDS[multiple](VERTEX, handles), Counter(handles if multiple else set(handles))

    def node(symbol, left, right):
        return symbol(left[0], right[0]), OPERATORS[symbol](left[1], right[1])

    leaves = st.builds(leaf, st.booleans(), handles)
    trees = st.recursive(
        leaves, lambda part: st.builds(node, st.sampled_from(list(OPERATORS)), part, part), max_leaves=7
    )
    return draw(trees)


@given(expressions())
def test_expression(made):
    expression, counter = made
    check_answers(expression, counter)
    evaluated = expression.evaluate()
    assert isinstance(evaluated, ElementMultiset) == expression.multiple
    assert evaluated.handles.tolist() == sorted(counter.elements())
    assert evaluated == expression
    if expression.levels:  # (of a set the data are shared, with all repeats)
        for kind, elements in zip(KINDS, (list(+counter), list(counter.elements())), strict=True):
            assert kind(expression).handles.tolist() == sorted(elements)
            assert len(kind(expression)) == len(elements)


@given(expressions(MANY), st.sampled_from([1, 2, 3]), st.sampled_from([1, 5]))
def test_expression_by_small_pages(made, first, largest):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sets, "_FIRST_PAGE", first)
        patch.setattr(sets, "_LARGEST_PAGE", largest)
        check_answers(*made)


@pytest.mark.parametrize("symbol", OPERATORS)
@pytest.mark.parametrize("multiple", [(0, 0, 0), (1, 1, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0)])
def test_many_pages(symbol, multiple, rng):
    operands, counters = [], []
    for one in multiple:
        handles = np.repeat(rng.integers(0, 30_000, 20_000), rng.integers(1, 4, 20_000))
        operands.append(KINDS[one](VERTEX, handles))
        counters.append(Counter(handles.tolist() if one else set(handles.tolist())))
    expected = sorted(reduce(OPERATORS[symbol], counters).elements())
    expression = reduce(symbol, operands)
    assert list(expression) == expected
    assert expression.evaluate().handles.tolist() == expected
    assert expression == ElementMultiset(VERTEX, expected)
    for less in (expected[:-1], expected[1:]):
        assert expression != ElementMultiset(VERTEX, less)


def test_multiplicities_by_hand():
    twice, thrice, once = (
        kind(VERTEX, [7] * n) for kind, n in ((ElementMultiset, 2), (ElementMultiset, 3), (ElementSet, 5))
    )
    assert [(twice | thrice).count(7), (twice & thrice).count(7)] == [3, 2]
    assert [(twice ^ thrice).count(7), (thrice - twice).count(7), (twice - thrice).count(7)] == [1, 1, 0]
    assert [(thrice - once).count(7), (once - twice).count(7), (once | twice).count(7)] == [2, 0, 2]
    for handle in (7, 8):
        asked = ElementSet(VERTEX, [7, 8]) - (once - thrice - twice)  # not below 0 in between
        assert [asked.count(handle), asked.evaluate().count(handle)] == [1, 1]
    assert ((twice ^ twice) ^ thrice).count(7) == 3 != (twice ^ (twice ^ thrice)).count(7)  # ^ is not associative


def test_an_expression_sees_its_operands_when_it_is_asked():
    a, b = ElementSet(VERTEX, [1]), ElementMultiset(VERTEX, [2])
    expression = a | b
    a.insert(3)
    assert list(expression) == [1, 2]  # not committed
    a.commit()
    assert list(expression) == [1, 2, 3]
    b.assign(ElementSet(VERTEX, [9, 9]))
    assert list(expression) == [1, 3, 9, 9]


@pytest.mark.parametrize("make", [lambda a: a, lambda a: a | a, lambda a: (a | a) - ElementSet(VERTEX, [3])])
def test_iteration_goes_on_over_what_was_there(make):
    a = ElementSet(VERTEX, range(100))
    asked = make(a)
    expected, going_on = list(asked), iter(asked)
    a.clear()
    a.insert_range(range(500, 600))
    a.commit()
    assert list(going_on) == expected


def test_what_was_handed_out_stays(rng):
    a = ElementSet(VERTEX, [5, 1])
    handed_out, copy = a.handles, ElementSet(a).isolate()
    a.insert(3)
    a.commit()
    assert handed_out.tolist() == list(copy) == [1, 5]
    with pytest.raises(ValueError, match="read-only"):
        a.handles[0] = 2
    given_array = np.array([4, 2])
    b = ElementSet(VERTEX, given_array)
    given_array[:] = 9
    assert list(b) == [2, 4]


BIG = 400_000


@pytest.fixture(scope="module")
def big():
    """Three sets of 3.2 MB each, the third of which has all handles of the others, and a multiset with each of them twice."""
    a, b, c = np.arange(0, 2 * BIG, 2), np.arange(1, 2 * BIG, 2), np.arange(2 * BIG)
    return [
        ElementSet(VERTEX, a),
        ElementSet(VERTEX, b),
        ElementSet(VERTEX, c),
        ElementMultiset(VERTEX, np.repeat(a, 2)),
    ]


QUESTIONS = {
    "in": lambda a, b, c, m: 2 * BIG in (a | b) - c,
    "in with a multiset": lambda a, b, c, m: 7 in (m ^ a) & (m | b),
    "any": lambda a, b, c, m: (a | b | c).any() == INVALID,
    "empty, at once": lambda a, b, c, m: (c - a).is_empty(),
    "empty, after all of it": lambda a, b, c, m: not ((a | b) - c).is_empty(),
    "equal, after all of it": lambda a, b, c, m: a | b != c,
    "apart": lambda a, b, c, m: bool(a & b),
    "bool of a multiset": lambda a, b, c, m: not m,
    "one step": lambda a, b, c, m: next(iter(a | m)) != 0,
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_question_takes_no_memory_of_the_size_of_its_operands(big, question, monkeypatch):
    monkeypatch.setattr(ElementSet, "evaluate", None)  # nothing is worked out as a whole
    monkeypatch.setattr(ElementMultiset, "evaluate", None)
    QUESTIONS[question](*big)
    tracemalloc.start()
    try:
        assert not QUESTIONS[question](*big)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 8 * BIG / 4


class Counting(ElementSet):
    """A set that counts how many handles it is asked about, or lists."""

    looked_at = pages = 0

    def _count(self, handle):
        self.looked_at += 1
        return super()._count(handle)

    def _counts(self, handles):
        self.looked_at += len(handles)
        return super()._counts(handles)

    def _page(self, after, most):
        self.pages += 1
        return super()._page(after, most)


def test_a_question_is_answered_by_the_first_element():
    a, b, c = (Counting(VERTEX, range(start, 10**5)) for start in (0, 10, 20))
    expression = (a | b) - c
    assert 5 in expression
    assert [one.looked_at for one in (a, b, c)] == [1, 1, 1]
    assert expression.any() == 0
    assert not expression.is_empty()
    assert max(one.looked_at for one in (a, b, c)) < 100


def test_pages_grow():
    a = Counting(VERTEX, range(10**5))
    assert (a - ElementSet(a)).is_empty()
    assert a.pages < 50


def test_an_intersection_is_looked_for_in_the_smallest():
    large, small = Counting(VERTEX, range(10**5)), Counting(VERTEX, [10**5 + 1, 10**5 + 2])
    for expression in (large & small, small & large, (large | large) & small, large & (small | small)):
        large.looked_at = 0
        assert expression.is_empty()
        assert large.looked_at <= 4


def test_a_long_union_is_one_level():
    union = reduce(operator.or_, [ElementSet(VERTEX, [i, i + 1]) for i in range(3000)])
    assert union.levels == 1
    assert union.evaluate().handles.tolist() == list(union) == list(range(3001))
    assert 3000 in union


def test_a_deep_expression_is_answered_or_refused():
    a, b = ElementSet(VERTEX, [1, 2]), ElementSet(VERTEX, [2])
    for grow in (
        lambda deep: (deep | b) - b,
        lambda deep: a - deep,
        lambda deep: b | deep,
        lambda deep: (b | b) | deep,
    ):
        deep = a
        while deep.levels < 99:
            deep = grow(deep)
        assert {*deep, *deep.evaluate()} <= {1, 2}
        assert deep == deep.evaluate()
        with pytest.raises(InputError, match="an expression of more than 100 levels; evaluate"):
            grow(grow(deep))


def test_commit_of_a_long_sorted_set_with_a_short_tail(rng):
    long = np.sort(rng.integers(0, 10**12, 10**6))
    mine = ElementMultiset(VERTEX, long)
    short = [10**12 + 1, 0, int(long[500]), 17, 17]
    mine.insert_range(short)
    mine.insert(3)
    assert (mine.size, mine.committed_size, mine.is_committed()) == (10**6 + 6, 10**6, False)
    mine.commit()
    assert mine.is_committed()
    assert np.array_equal(mine.handles, np.sort(np.concatenate((long, short, [3]))))
    assert mine.count(17) == 2 + (long == 17).sum()


def test_repeats_stay_until_unique():
    a = ElementSet(VERTEX, [4, 4, 1])
    shared = ElementMultiset(a)
    a.insert(1)
    a.commit()
    assert (list(a), list(shared), len(a)) == ([1, 4], [1, 1, 4, 4], 4)
    a.insert(4)
    a.unique()
    assert (list(shared), len(a), a.committed_size) == ([1, 4], 3, 2)


@pytest.mark.parametrize(
    ("handles", "message"),
    [
        ([1.0], "a handle is a whole number, not 1.0"),
        ([2, True], "a handle is a whole number, not True"),
        ([None], "a handle is a whole number, not None"),
        ("12", "a handle is a whole number, not '1'"),
        (np.array([1.5, 2]), "a handle is a whole number, not np.float64\\(1.5\\)"),
        (np.array([True]), "a handle is a whole number, not np.True_"),
        ([INVALID], "-1 is the invalid handle, of no element"),
        (np.array([3, -1]), "-1 is the invalid handle, of no element"),
        ([-2], "-2 is no handle, which go from 0 to 2\\^63 - 1"),
        ([2**63], f"{2**63} is no handle"),
        (np.array([2**63], np.uint64), f"{2**63} is no handle"),
        (np.array([[1, 2]]), "handles are an array of the shape \\(n,\\), not \\(1, 2\\)"),
        (7, "handles are several whole numbers, not 7"),
    ],
)
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_no_handle(kind, handles, message):
    with pytest.raises(InputError, match=f"^{message}"):
        kind(VERTEX, handles)
    mine = kind(VERTEX, [5])
    with pytest.raises(InputError, match=message):
        mine.insert_range(handles)
    assert mine.size == 1


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int32, np.uint32, np.int64, np.uint64])
def test_any_type_of_integer(dtype):
    assert list(ElementSet(VERTEX, np.array([[3, 0], [1, 0], [100, 0]], dtype)[:, 0])) == [1, 3, 100]  # not contiguous


def test_no_handles_at_all():
    for nothing in ((), np.array([]), np.array([], np.int32), iter([]), ElementSet(VERTEX)):
        assert ElementSet(VERTEX, nothing) == ElementMultiset(VERTEX)


@pytest.mark.parametrize("symbol", OPERATORS)
def test_algebra_with_an_empty_operand(symbol):
    for a in (ElementSet(VERTEX, [1, 5]), ElementMultiset(VERTEX, [1, 1, 5])):
        for nothing in (ElementSet(VERTEX), ElementMultiset(VERTEX), a - a):
            check_answers(symbol(a, nothing), OPERATORS[symbol](Counter(list(a)), Counter()))
            check_answers(symbol(nothing, a), OPERATORS[symbol](Counter(), Counter(list(a))))
            check_answers(symbol(nothing, nothing), Counter())


@pytest.mark.parametrize("question", [1.0, True, None, "1", np.array([1])])
def test_asking_for_what_is_no_handle(question):
    a = ElementSet(VERTEX, [1])
    for asked in (a, a | a):
        with pytest.raises(InputError, match="a handle is a whole number"):
            question in asked  # noqa: B015


def test_kinds_do_not_mix():
    a, b = ElementSet(VERTEX, [1]), ElementMultiset(Element.TETRAHEDRON, [1])
    message = "elements of two kinds, {} and {}:"
    for mix in OPERATORS:
        with pytest.raises(InputError, match=message.format("vertex", "tetra")):
            mix(a, b)
        with pytest.raises(InputError, match=message.format("tetra", "vertex")):
            mix(b | b, a | a)
    for mix in (a.assign, a.swap, a.insert_range, lambda other: a.assign(other | other)):
        with pytest.raises(InputError, match=message.format("vertex", "tetra")):
            mix(b)
    assert a != b
    assert ElementSet(VERTEX) != ElementSet(Element.EDGE)


def test_what_is_no_set():
    a = ElementSet(VERTEX, [1])
    for wrong in (lambda: ElementSet("vertex"), lambda: ElementSet([1]), lambda: ElementSet(a, [1])):
        with pytest.raises(InputError, match="a set is made of a kind"):
            wrong()
    with pytest.raises(InputError, match="can be assigned"):
        a.assign([1])
    with pytest.raises(InputError, match="can be swapped"):
        a.swap(a | a)
    for symbol in OPERATORS:
        with pytest.raises(TypeError):
            symbol(a, {1})
    assert a != {1}
    with pytest.raises(TypeError):
        hash(a)


def test_what_a_person_reads():
    a, m = ElementSet(VERTEX, [4, 1, 4]), ElementMultiset(VERTEX, range(1000))
    a.insert(2)
    assert repr(a) == "<vertex set {1, 4}, 1 not committed>"
    assert repr(m) == "<vertex multiset {0, 1, 2, 3, 4, 5, 6, 7, ... of 1,000}>"
    assert repr(ElementMultiset(Element.BORDER_HALFFACE)) == "<border half-face multiset {}>"
    b = ElementSet(VERTEX, [9])
    assert repr((a | b | b) - (b & a)) == "<vertex expression ({1, 4} | {9} | {9}) - ({9} & {1, 4})>"
    assert repr(reduce(operator.or_, [b] * 20)).endswith("{9} | ...>")

"""Moves to anywhere, steps, other rules and other structures at random, on all structures at once, and on the twin."""

import numpy as np
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from tests.collision.audit import audit
from tests.collision.starts import SLOW, STARTS
from tests.collision.variants import EXACT, variant
from tetrabench.collision.simulation import Simulation
from tetrabench.collision.twin import Twin

BEGIN = {
    "kdtree": variant("kdtree"),
    "kdtree 1": variant("kdtree", capacity=1, per_leaf=0),
    "kdtree 3": variant("kdtree", capacity=3, median=1),
    "kdtree 12": variant("kdtree", capacity=12),
    "grid": variant("grid", per_ten=20),
    "skin": variant("skin", skin=100),
    "skin 1000": variant("skin", skin=1000),
    "ckdtree": variant("ckdtree", capacity=3),
}
COORDINATE = st.one_of(
    st.integers(-2, 18).map(lambda k: 8.0 * k),  # many in one place, and on splits
    st.floats(-50, 150).map(lambda x: round(x, 6)),  # nearer than 1e-150 the square of a distance is 0
    st.sampled_from([-0.0, 1e6, -1e9, 2.0**-30]),
)
VELOCITY = st.integers(-5, 4).map(lambda k: 0.5 * k)
NUMBERS = st.lists(st.integers(0, 10**6), min_size=1, max_size=40)


class AllTogether(RuleBasedStateMachine):
    """The same happens everywhere; all are in the same state, to the last bit, and sound."""

    @initialize(name=st.sampled_from(sorted(STARTS)), mode=st.sampled_from(["paper", "full"]))
    def begin(self, name, mode):
        start = STARTS[name]()
        self.simulations = {name: Simulation(start, structure, mode=mode) for name, structure in BEGIN.items()}
        self.twin = Twin(start, mode=mode)
        self.size = len(start.objects.x)

    def some(self, numbers):
        return sorted({number % self.size for number in numbers}) if self.size else []

    @rule(numbers=NUMBERS, x=COORDINATE, y=COORDINATE)
    def gather(self, numbers, x, y):
        for i in self.some(numbers):
            self.place(i, x, y)

    @rule(numbers=NUMBERS, data=st.data())
    def scatter(self, numbers, data):
        for i in self.some(numbers):
            self.place(i, data.draw(COORDINATE), data.draw(COORDINATE))

    @rule(numbers=NUMBERS, dx=st.floats(-30, 30).map(lambda x: round(x, 6)), along_x=st.booleans())
    def shift(self, numbers, dx, along_x):
        for i in self.some(numbers):
            self.place(i, self.twin.x[i] + (dx if along_x else 0), self.twin.y[i] + (0 if along_x else dx))

    def place(self, i, x, y):
        self.twin.x[i], self.twin.y[i] = x, y
        for simulation in self.simulations.values():
            simulation.objects.x[i], simulation.objects.y[i] = x, y

    @rule(numbers=NUMBERS, vx=VELOCITY, vy=VELOCITY)
    def push(self, numbers, vx, vy):
        for i in self.some(numbers):
            self.twin.vx[i], self.twin.vy[i] = vx, vy
            for simulation in self.simulations.values():
                simulation.objects.vx[i], simulation.objects.vy[i] = vx, vy

    @rule(count=st.integers(1, 2 if SLOW else 5))
    def step(self, count):
        for _ in range(count):
            self.twin.step()
            for simulation in self.simulations.values():
                simulation.step()
            if self.twin.mode == "full":  # whose words say nothing of the order in which it is rounded
                one = next(iter(self.simulations.values())).objects
                ours = self.twin.x, self.twin.y, self.twin.vx, self.twin.vy
                np.testing.assert_allclose(ours, one[:4], rtol=1e-9, atol=1e-6)
                self.twin.take(one)
        assert {simulation.contacts for simulation in self.simulations.values()} == {self.twin.contacts}

    @rule(gravity=st.sampled_from([0.0, 0.1, -0.5]), bounce=st.sampled_from([0.0, 0.9, 1.0]))
    def change_rules(self, gravity, bounce):
        for simulation in [self.twin, *self.simulations.values()]:
            simulation.gravity, simulation.bounce = gravity, bounce

    @rule(mode=st.sampled_from(["paper", "full"]))
    def change_mode(self, mode):
        for simulation in [self.twin, *self.simulations.values()]:
            simulation.mode = mode

    @rule(name=st.sampled_from(sorted(BEGIN)), other=st.sampled_from(sorted(EXACT)))
    def rebuild(self, name, other):
        self.simulations[name].rebuild(EXACT[other])

    @rule(x=st.tuples(COORDINATE, COORDINATE), y=st.tuples(COORDINATE, COORDINATE))
    def ask_rectangle(self, x, y):
        inside = self.twin.within(x[0], y[0], x[1], y[1])
        for name, simulation in self.simulations.items():
            assert simulation.query_rect(x[0], y[0], x[1], y[1]).tolist() == inside, name

    @rule(a=st.integers(0, 10**6), b=st.integers(0, 10**6))
    def ask_rectangle_between_two(self, a, b):
        if self.size:
            a, b = a % self.size, b % self.size
            xs, ys = sorted((self.twin.x[a], self.twin.x[b])), sorted((self.twin.y[a], self.twin.y[b]))
            self.ask_rectangle(xs, ys)

    @rule()
    def ask_pairs(self):
        found = [list(pair) for pair in self.twin.pairs()]
        for name, simulation in self.simulations.items():
            assert simulation.find_pairs().tolist() == found, name
            assert audit(simulation.storage, simulation.objects) == [], name

    @invariant()
    def all_are_alike(self):
        if not hasattr(self, "twin"):
            return
        state = [self.twin.x, self.twin.y, self.twin.vx, self.twin.vy]
        for name, simulation in self.simulations.items():
            assert [column.tolist() for column in simulation.objects[:4]] == state, name


TestAllTogether = AllTogether.TestCase

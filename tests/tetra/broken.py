"""A plug-in of broken tetra contestants: v3y with one function wrong, each named after that. Plain Python only."""

import os
import signal
from dataclasses import replace

import numpy as np

from tests.broken import broken_type
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.backends.tetra.layouts.property_arrays import PropertyArrays
from tetrabench.backends.tetra.slots.chain import Chain
from tetrabench.backends.tetra.slots.flag_list import FlagList
from tetrabench.tetra import interface
from tetrabench.tetra.incidence import Incidence
from tetrabench.tetra.interface import NONE, Cursor
from tetrabench.tetra.points import COUNT, EDITS

GOOD = next(one for one in OURS if one.name == "v3y")
LINKED = next(one for one in OURS if one.name == "v4")
AXES = {PropertyArrays: "layout", FlagList: "slots", Incidence: "incidence", Chain: "slots"}


def broken(name, good, function, wrap, without=(), **says):
    made = broken_type(good, {function: wrap} if function else {}, without)
    base = LINKED if good is Chain else GOOD

    def build(mesh):
        net = base.build(mesh)
        axis = AXES[good]
        return net._replace(**{axis: made(*getattr(net, axis))})

    return replace(base, name=name, build=build, **says)


def set_volume(good):
    def set_volume(net, t, value):
        net.layout.volume[t] = np.float32(value)

    return set_volume


def set_state(good):
    def set_state(net, t, k, value):
        good(net, t, k, value)
        if k == 4:
            net.layout.side_area[t, 3] = value

    return set_state


def set_vertex(good):
    def set_vertex(net, t, i, point):
        good(net, t, i, np.uint16(int(point) & 0xFFFF))

    return set_vertex


def neighbour(good):
    def neighbour(net, t, i):
        return good(net, t, i) if i != 2 else NONE

    return neighbour


def set_neighbour(good):
    def set_neighbour(net, t, i, other):
        if other != NONE or i < 3:
            good(net, t, i, other)

    return set_neighbour


def side_normal(good):
    def side_normal(net, t, i, k):
        return good(net, t, i, k) if i else -good(net, t, i, k)

    return side_normal


def grown_layout(good):
    def grown_layout(net, capacity):
        grown = good(net, capacity)
        grown.state[7, 3] = -1.0
        return grown

    return grown_layout


def columns_copied(good):
    def columns(net):
        return {name: column.copy() for name, column in good(net).items()}

    return columns


def columns_misnamed(good):
    def columns(net):
        return {f"{name}s": column for name, column in good(net).items()}

    return columns


def let_go(good):
    def let_go(net, held, undo):
        good(net, held, undo)
        if undo:
            interface.set_state(net, int(held.refs[3]), 2, 77.0)

    return let_go


def capacity(good):
    def capacity(net):
        return 0

    return capacity


def number_of_tetras(good):
    def number_of_tetras(net):
        return good(net) - (good(net) == 20)

    return number_of_tetras


def next_twice(good):
    def next_tetra(net, cursor):
        return Cursor(cursor.tetra, 0, cursor.limit) if cursor.tetra == 5 else good(net, cursor)

    return next_tetra


def next_forgets(good):
    def next_tetra(net, cursor):
        following = good(net, cursor)
        return good(net, following) if following.tetra == 5 else following

    return next_tetra


def endless(good):
    def next_tetra(net, cursor):
        while True:
            pass

    return next_tetra


def last_tetra(good):
    def last_tetra(net):
        return np.int64(0)

    return last_tetra


def is_live(good):
    def is_live(net, t):
        return t >= 0

    return is_live


def slots_used(good):
    def slots_used(net):
        return 0

    return slots_used


def grown_slots(good):
    def grown_slots(net, capacity):
        return type(net.slots)(good(net, capacity).holes, net.slots.counters)

    return grown_slots


def slot_faults(good):
    def slot_faults(net):
        return net.slots.counters[2]

    return slot_faults


def crashing(good):
    def drop_slot(net, t):
        os.kill(os.getpid(), signal.SIGSEGV)

    return drop_slot


def raising(good):
    def take_slot(net):
        raise RuntimeError("I would rather not\nsecond line")

    return take_slot


def a_tetra_around(good):
    def a_tetra_around(net, point):
        return NONE if point == 1 else good(net, point)

    return a_tetra_around


def fill_around(good):
    def fill_around(net, point, buffer):
        n = good(net, point, buffer)
        if n < len(buffer):
            buffer[n] = 0
        return n

    return fill_around


def insert_takes_all(good):
    def insert_tetra(net, a, b, c, d):
        try:
            return good(net, a, b, c, d)
        except ValueError:
            return NONE

    return insert_tetra


def insert_turns(good):
    def insert_tetra(net, a, b, c, d):
        return good(net, b, a, c, d)

    return insert_tetra


def insert_marks(good):
    """What is refused leaves something behind."""

    def insert_tetra(net, a, b, c, d):
        try:
            return good(net, a, b, c, d)
        except ValueError:
            net.layout.state[interface.last_tetra(net), 0] = 99.0
            raise

    return insert_tetra


def delete_forgets(good):
    def delete_tetra(net, t):
        others = [interface.neighbour(net, t, i) for i in range(4)]
        good(net, t)
        for u in others:
            if u != NONE:
                free = [j for j in range(4) if interface.neighbour(net, u, j) == NONE]
                net.layout.neighbour[u, free[0]] = t

    return delete_tetra


def delete_uncounted(good):
    def delete_tetra(net, t):
        good(net, t)
        net.points.counters[EDITS] -= 1

    return delete_tetra


def split_many(good):
    def split_many(net, refs):
        return good(net, refs)[0], 0

    return split_many


def split_loses(good):
    def split_many(net, refs):
        net, skipped = good(net, refs)
        for t in range(interface.number_of_tetras(net)):
            net.layout.state[t, 1] = 0.0
        return net, skipped

    return split_many


def collect(good):
    def collect(net):
        return net, True

    return collect


def incidence_room(good):
    def incidence_room(net):
        return good(net) // 2

    return incidence_room


def enter_point(good):
    def enter_point(net, point):
        net.points.counters[COUNT] += 1

    return enter_point


# name -> what is broken; what its sentence must name
FAULTS = {
    "narrow-volume": (PropertyArrays, interface.set_volume, set_volume, "volume"),
    "state-over-area": (PropertyArrays, interface.set_state, set_state, "side_area"),
    "narrow-vertex": (PropertyArrays, interface.set_vertex, set_vertex, "set_vertex"),
    "blind-side": (PropertyArrays, interface.neighbour, neighbour, "neighbour"),
    "stuck-neighbour": (PropertyArrays, interface.set_neighbour, set_neighbour, "neighbour"),
    "inward-normal": (PropertyArrays, interface.side_normal, side_normal, "side_normal"),
    "growth-loses": (PropertyArrays, interface.grown_layout, grown_layout, "grown_layout lost state(7, 3)"),
    "columns-copied": (PropertyArrays, interface.columns, columns_copied, "columns: state of tetra 0"),
    "columns-misnamed": (PropertyArrays, interface.columns, columns_misnamed, "columns: there is no field 'vertexs'"),
    "undoes-too-much": (Chain, interface.let_go, let_go, "an edit that was undone (hold, let_go): state("),
    "stingy-capacity": (PropertyArrays, interface.capacity, capacity, "capacity gives 0"),
    "miscounting": (FlagList, interface.number_of_tetras, number_of_tetras, "number_of_tetras"),
    "next-twice": (FlagList, interface.next_tetra, next_twice, "next_tetra gives tetra 5 twice"),
    "next-forgets": (FlagList, interface.next_tetra, next_forgets, "next_tetra"),
    "last-first": (FlagList, interface.last_tetra, last_tetra, "last_tetra"),
    "dead-live": (FlagList, interface.is_live, is_live, "is_live"),
    "no-slots": (FlagList, interface.slots_used, slots_used, "slots_used"),
    "shared-counters": (FlagList, interface.grown_slots, grown_slots, "grown_slots"),
    "nervous-audit": (FlagList, interface.slot_faults, slot_faults, "slot_faults"),
    "raising": (FlagList, interface.take_slot, raising, "take_slot: RuntimeError: I would rather not"),
    "lonely-point": (Incidence, interface.a_tetra_around, a_tetra_around, "a_tetra_around(1)"),
    "writes-beyond": (Incidence, interface.fill_around, fill_around, "fill_around"),
    "takes-all": (Incidence, interface.insert_tetra, insert_takes_all, "insert_tetra"),
    "turns": (Incidence, interface.insert_tetra, insert_turns, "insert_tetra"),
    "marks": (Incidence, interface.insert_tetra, insert_marks, "insert_tetra"),
    "forgets": (Incidence, interface.delete_tetra, delete_forgets, "delete_tetra"),
    "uncounted": (Incidence, interface.delete_tetra, delete_uncounted, "delete_tetra"),
    "skips-in-silence": (Incidence, interface.split_many, split_many, "split_many"),
    "split-loses": (Incidence, interface.split_many, split_loses, "split_many"),
    "collects-nothing": (Incidence, interface.collect, collect, "collect"),
    "stingy-room": (Incidence, interface.incidence_room, incidence_room, "incidence_room gives 0, for 1"),
    "two-points": (Incidence, interface.enter_point, enter_point, "enter_point"),
}

CONTESTANTS = [
    *(broken(name, good, function, wrap) for name, (good, function, wrap, _) in FAULTS.items()),
    broken(
        "half",
        PropertyArrays,
        None,
        None,
        without=(interface.centroid, interface.set_centroid, interface.grown_layout),
    ),
    broken("crashing", FlagList, interface.drop_slot, crashing),
    broken("endless", FlagList, interface.next_tetra, endless),
]

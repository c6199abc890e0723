"""A plug-in of broken formats: tables with one function wrong, each named after what is wrong with it. Plain Python only."""

import os
import signal
from dataclasses import replace

from tests.broken import broken_type
from tetrabench.backends.polygon import FORMATS
from tetrabench.backends.polygon.tables import Tables
from tetrabench.polygon import interface

GOOD = FORMATS["tables"]


def broken(name, function, wrap, without=()):
    made = broken_type(Tables, {function: wrap} if function else {}, without)
    return replace(GOOD, name=name, build=lambda links: made(*GOOD.build(links)))


def changed(change):
    """A query whose list is changed by `change(out, count) -> count`."""

    def wrap(good):
        def query(storage, element, out):
            return change(out, good(storage, element, out))

        query.__signature__ = good.__signature__
        return query

    return wrap


def one_less(out, count):
    return count - 1


def backwards(out, count):
    out[:count] = out[:count][::-1].copy()
    return count


def turned(out, count):
    out[:count] = [*out[1:count], out[0]]
    return count


def one_condition(out, count):
    out[:count][out[:count] < 0] = -1
    return count


def without_conditions(out, count):
    return int((out[:count] >= 0).sum())


def boasting(out, count):
    return len(out) + 1


def star_turned(good):
    def node_star(storage, v, nodes, cells):
        count = good(storage, v, nodes, cells)
        cells[:count] = [*cells[1:count], cells[0]]
        return count

    return node_star


def count_of(answer):
    def wrap(good):
        def number(storage):
            return good(storage) + answer

        return number

    return wrap


def crashing(good):
    def node_cells(storage, v, out):
        os.kill(os.getpid(), signal.SIGSEGV)

    return node_cells


def endless(good):
    def cell_nodes(storage, c, out):
        while True:
            pass

    return cell_nodes


# name -> what is broken; what its sentence must name
FAULTS = {
    "too-many-cells": (interface.number_of_cells, count_of(1), "number_of_cells"),
    "too-few-nodes": (interface.number_of_nodes, count_of(-1), "number_of_nodes"),
    "cell-short": (interface.cell_nodes, changed(one_less), "cell_nodes"),
    "cell-clockwise": (interface.cell_nodes, changed(backwards), "cell_nodes"),
    "cell-turned": (interface.cell_nodes, changed(turned), "cell_n"),
    "neighbours-turned": (interface.cell_neighbours, changed(turned), "cell_neighbours"),
    "one-condition": (interface.cell_neighbours, changed(one_condition), "cell_neighbours"),
    "around-short": (interface.node_cells, changed(without_conditions), "node_cells"),
    "around-clockwise": (interface.node_cells, changed(backwards), "node_cells"),
    "around-turned": (interface.node_cells, changed(turned), "node_cells"),
    "boasting": (interface.node_neighbours, changed(boasting), "node_neighbours(0) returns"),
    "fan-clockwise": (interface.node_neighbours, changed(backwards), "node_neighbours"),
    "fan-turned": (interface.node_neighbours, changed(turned), "node_neighbours"),
    "star-turned": (interface.node_star, star_turned, "node_star"),
}
CONTESTANTS = [
    *(broken(name, function, wrap) for name, (function, wrap, _) in FAULTS.items()),
    broken("half", None, None, without=(interface.node_star, interface.cell_nodes)),
    broken("crashing", interface.node_cells, crashing),
    broken("endless", interface.cell_nodes, endless),
]

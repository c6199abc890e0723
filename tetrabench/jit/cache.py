"""`kernel`: numba's njit with a disk cache that cannot serve stale, foreign or half-written code.

numba's own cache has three traps, each of which was seen to spring:

1. It looks at the file of the outermost function alone: a change in an implementation that was inlined from another
   file leaves a stale kernel. Here the folder of an entry carries a hash of every source file that the kernel can
   have been made from: the kernel-bearing packages of the harness and of the family, the distribution of each
   storage class in its signature, and of what others have written also what it names: see `reach`. (Not the whole
   package: editing a chart recompiles nothing.)
2. Its key ignores the compiler's flags: a warm cache runs without bounds checks when they are asked for. Here the
   hash covers the flags.
3. Its index is read and rewritten without a lock: processes that compile at once lose entries, or swap them. Here
   each contestant has a folder of its own, and compilation happens under that folder's file lock.

The cache lives in the user's cache directory, or where TETRABENCH_CACHE says. numba's process-wide settings, and with
them the user's own kernels, stay as they are.
"""

import functools
import hashlib
import importlib
import inspect
import platform
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numba
from filelock import FileLock
from numba import config, njit, types
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
    _CacheLocator,
)

from tetrabench.folders import cache_root
from tetrabench.jit.generic import implementations_of
from tetrabench.jit.reach import is_foreign, reach

_HARNESS = "tetrabench"
_MACHINERY = f"{_HARNESS}.jit"
_LAYERS = ("mesh", "io", "tetra", "polygon", "collision")
_LIBRARY = tuple(f"{_HARNESS}.{layer}" for layer in _LAYERS)  # what foreign kernels may call
_KERNELS: list[Any] = []  # every dispatcher that `kernel` made, for tests and for counting


def kernel(function: Callable[..., Any] | None = None, *, allocates: bool = True, inline: bool = False) -> Any:
    """Compile `function` on first call, through the project's cache.

    The function must also run as plain Python (NUMBA_DISABLE_JIT=1). Divisions follow IEEE 754 (`1.0 / 0.0` is inf,
    no exception), and no fast-math flag is ever set: answers are compared bit by bit.

    Args:
        function: what to compile.
        allocates: False promises that the function makes no array, and gets none from what it calls. Then numba
            counts no references in it: a count is an atomic operation on every array of the net, at worst at each
            step of a sweep, and one that an exception leaves behind keeps the whole net in memory for good.
        inline: put it into each kernel that calls it: for what takes a net, by value, and does less than that costs.
    """
    if function is None:
        return functools.partial(kernel, allocates=allocates, inline=inline)
    compiled = njit(error_model="numpy", _nrt=allocates, forceinline=inline)(function)
    if compiled is function:  # the JIT is off
        return function
    cache = _Cache(function)
    compile_unlocked = compiled.compile

    @functools.wraps(compile_unlocked)
    def compile_locked(signature: Any) -> Any:
        with cache.lock(signature):
            return compile_unlocked(signature)

    compiled._cache = cache
    compiled.compile = compile_locked
    _KERNELS.append(compiled)
    return compiled


def kernels() -> Iterator[Any]:
    """Every kernel that has been declared in this process, with `.signatures` and `.stats` as numba gives them."""
    return iter(_KERNELS)


def count_compiled() -> int:
    """How many kernels this process has compiled, rather than found in the cache."""
    return sum(sum(compiled.stats.cache_misses.values()) for compiled in _KERNELS)


class _Locator(_CacheLocator):  # type: ignore[misc]
    """Tells numba to look nowhere: `_Cache` chooses the folder, by signature."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        self._py_file = py_file
        self._disambiguator = py_func.__module__ + str(py_func.__code__.co_firstlineno)

    def get_cache_path(self) -> str:
        return str(cache_root() / "kernels")

    def ensure_cache_path(self) -> None:
        pass

    def get_source_stamp(self) -> str:
        return ""

    def get_disambiguator(self) -> str:
        return self._disambiguator

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> "_Locator":
        return cls(py_func, py_file)


class _CacheImpl(CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_Locator,)


class _Cache(FunctionCache):  # type: ignore[misc]
    """numba's cache of one function, in a folder chosen by the storage classes in the signature."""

    _impl_class = _CacheImpl

    def lock(self, signature: Any) -> Any:
        """The file lock of the signature's folder; it may be taken again by whoever holds it."""
        try:
            return _file_lock(self._folder(signature) / ".lock")
        except OSError:  # a cache that cannot be written is no cache, and no reason to stop
            return nullcontext()

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            self._cache_file = self._file(sig)
            return super()._load_overload(sig, target_context)
        except OSError:
            return None

    def _save_overload(self, sig: Any, data: Any) -> None:
        try:
            self._cache_file = self._file(sig)
            super()._save_overload(sig, data)
        except OSError:
            pass

    def _file(self, signature: Any) -> Any:
        return IndexDataCacheFile(str(self._folder(signature)), self._impl.filename_base, source_stamp="")

    def _folder(self, signature: Any) -> Path:
        arguments = signature.args if hasattr(signature, "args") else signature
        storages = sorted(set(_storage_classes(arguments)), key=lambda cls: (cls.__module__, cls.__qualname__))
        label = "-".join(cls.__name__ for cls in storages if _is_contestants(cls.__module__)) or "common"
        theirs = [one for cls in storages if is_foreign(cls.__module__) for one in implementations_of(cls)]
        reached, constants = reach([self._py_func, *theirs])
        modules = tuple(sorted({self._py_func.__module__, *(cls.__module__ for cls in storages), *reached}))
        folder = Path(self._cache_path) / f"{label}-{_stamp(modules, tuple(sorted(constants)), _flags())[:16]}"
        folder.mkdir(parents=True, exist_ok=True)
        return folder


@functools.cache
def _file_lock(path: Path) -> FileLock:
    return FileLock(path)


def _is_contestants(module: str) -> bool:
    """Whether a storage class belongs to contestants, rather than to the interface they share."""
    return module.split(".")[0] != _HARNESS or module.startswith(f"{_HARNESS}.backends.")


def _storage_classes(arguments: Iterable[Any]) -> Iterator[type]:
    """The NamedTuple classes in a signature, however deep."""
    for argument in arguments:
        if isinstance(argument, types.BaseNamedTuple):
            yield argument.instance_class
        if isinstance(argument, types.BaseTuple):
            yield from _storage_classes(argument)


def _flags() -> str:
    """What else decides the code: the compiler, its settings, and the processor it compiles for."""
    names = "BOUNDSCHECK OPT DEBUGINFO_DEFAULT ENABLE_AVX CPU_NAME CPU_FEATURES LOOP_VECTORIZE SLP_VECTORIZE"
    settings = {name: getattr(config, name, None) for name in names.split()}
    return f"{numba.__version__} {sys.version} {platform.machine()} {settings}"


@functools.cache
def _stamp(modules: tuple[str, ...], constants: tuple[str, ...], flags: str) -> str:
    digest = hashlib.sha256("\0".join([flags, *constants]).encode(errors="surrogatepass"))
    for package in sorted({package for module in modules for package in _packages(module)} | {_MACHINERY}):
        digest.update(package.encode() + b"\0")  # entries know classes by the names of their modules
        for path, content in _sources(package):
            digest.update(path.encode() + b"\0" + content + b"\0")
    return digest.hexdigest()


def _packages(module: str) -> Iterator[str]:
    """The kernel-bearing packages behind a module: its layer and family, or its distribution and our library."""
    parts = module.split(".")
    if parts[0] != _HARNESS:
        yield from (parts[0], *_LIBRARY)
    elif parts[1] in ("backends", "scenarios"):
        yield ".".join(parts[:3])
        yield f"{_HARNESS}.{parts[2]}"  # the family's interface
    else:
        yield ".".join(parts[:2])


def _sources(package: str) -> Iterator[tuple[str, bytes]]:
    """Every Python file of a package (or the one file of a module), in a fixed order.

    Raises:
        FileNotFoundError: there is no file, as of a cell of a notebook: nothing tells when it changes, so that what is
            made of it must not be kept.
    """
    try:
        module = importlib.import_module(package)
        file = inspect.getsourcefile(module)
    except (ImportError, TypeError, ValueError):
        file = None
    if file is None:
        raise FileNotFoundError(f"{package} was typed in")
    top = Path(file)
    for path in sorted(top.parent.rglob("*.py")) if hasattr(module, "__path__") else [top]:
        yield path.relative_to(top.parent).as_posix(), path.read_bytes()

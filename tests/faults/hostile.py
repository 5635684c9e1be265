"""Hostile files: valid ones of every kind, and ways to spoil them."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hypothesis import strategies as st

from storage.quarantine import SCRIPT
from tests.faults.conftest import TINY

CANARY = "canary"
CASES = "material,friction,radius,load\nBaTiO3,0.3,0.05,1e5\nPZT-4,0,0.1,2e4\n"
_CONSTANTS = {"c11": 2.7e11, "c12": 1.2e11, "c13": 1.2e11, "c33": 2.7e11, "c44": 7.7e10, "e31": -4.4, "e33": 18.6}
_CONSTANTS |= {"e15": 11.6, "eps11": 1.1e-8, "eps33": 1.26e-8, "mu11": 5e-6, "mu33": 1e-5}
MATERIAL = "name: mine\nsource: a book\n" + "".join(f"{name}: {value:.9g}\n" for name, value in _CONSTANTS.items())
POINTS = "volume_fraction,friction,load,radius\n0.5,0.2,10000,0.05\n0.45,0.0,20000,0.1\n"
STUDY = TINY + f"materials: []\nphases: [BaTiO3, CoFe2O4]\ndescription: {CANARY}\n"

#: What people try: code in YAML and formulas, paths, bombs, numbers beyond every range, control characters.
PAYLOADS = [
    f"!!python/object/apply:os.system ['touch {CANARY}']",
    f"!!python/object/new:subprocess.Popen [[touch, {CANARY}]]", f"__import__('os').system('touch {CANARY}')",
    f"abs(__import__('os').system('touch {CANARY}'))", "{{ ''.__class__.__mro__[1].__subclasses__() }}",
    f"$(touch {CANARY})", f"; touch {CANARY} #", f"=cmd|'/C touch {CANARY}'!A0", f"../../{CANARY}",
    f"/tmp/../{CANARY}", "file:///etc/passwd", "/dev/zero", "/dev/random", "[" * 3000, "{a: " * 2000, "- " * 3000,
    "&a [*a, *a]", "&a {<<: *a}", "<<: {load: 1}", "1e999", "-1e308", "1e-320", ".nan", "nan", "-.inf",
    "0x7fffffffffffffff", "9" * 5000, "9" * 4000, "1_000", "010", "0b11", "1_00_000", "\u0663", "\x1b]0;owned\x07",
    "0o17", "1:30:00", "2026-01-01", "yes", "~", "\0", "\x1b[31m", "\u202e", "\ufeff", "\r\n\r\n", '"' * 3,
    "x" * 70_000, "1000000000", "-1", "levels: 1000", "!!binary aGVsbG8=", "!!set {a, b}", "!!bool maybe", "!!int ''",
    "!!timestamp x", "{radius: {lo: 0.03}}", "$x^$", r'"\ud800"', "1 V1/0", "1 kV999", "? [a]\n: b", "%YAML 9.9\n---",
    "---\n---",
]  # fmt: skip


@st.composite
def spoilt(draw: st.DrawFn, valid: str) -> bytes:
    """A valid text with pieces cut, doubled, replaced by bytes or by payloads."""
    text = valid.encode()
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(text)))
        end = draw(st.integers(place, min(place + 40, len(text))))
        piece = draw(
            st.one_of(
                st.sampled_from(PAYLOADS).map(lambda payload: payload.encode("utf-8", "surrogatepass")),
                st.binary(max_size=12),
                st.text(max_size=8).map(lambda part: part.encode("utf-8", "surrogatepass")),
                st.just(text[place:end] * 2),
                st.sampled_from([b"", b"\n", b": ", b", ", b"\n  ", b"'", b"0", b"-"]),
                st.floats().map(lambda number: repr(number).encode()),
            )
        )
        # where a value stands, as often as anywhere
        if draw(st.booleans()) and b": " in text:
            lines = text.split(b"\n")
            line = draw(st.integers(0, len(lines) - 1))
            head, colon, _ = lines[line].partition(b": ")
            lines[line] = head + colon + piece
            text = b"\n".join(lines)
        else:
            text = text[:place] + piece + text[end:]
    return text


_FORBIDDEN = (
    "os.system", "os.exec", "os.posix_spawn", "subprocess.Popen", "socket.connect", "ctypes.dlopen", "pty.spawn"
)  # fmt: skip
_guarded: list[Path] = []


def _watch(event: str, arguments: tuple[object, ...]) -> None:
    if not _guarded:
        return
    if event == "subprocess.Popen" and arguments[1][:3] == [sys.executable, "-I", SCRIPT]:  # type: ignore[index]
        return  # the trial that a file of unknown origin is put to
    if event == "ctypes.dlopen" and arguments[0] == sys.modules["netCDF4._netCDF4"].__file__:
        return  # what the trial asks, loaded already
    if event in _FORBIDDEN:
        raise AssertionError(f"a hostile file led to {event} {arguments[:1]}")
    if event == "open":
        path, mode, flags = arguments[:3]
        writes = isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if writes and isinstance(path, (str, bytes)) and os.fsdecode(path) != os.devnull:
            target = Path(os.fsdecode(path)).resolve()
            if not target.is_relative_to(_guarded[-1]):
                raise AssertionError(f"a hostile file led to a write to {target} ({mode})")


sys.addaudithook(_watch)


@contextmanager
def guarded(folder: Path) -> Iterator[None]:
    """No process is started, no connection made and nothing written outside a folder, or the test fails."""
    _guarded.append(folder.resolve())
    try:
        yield
    finally:
        _guarded.pop()

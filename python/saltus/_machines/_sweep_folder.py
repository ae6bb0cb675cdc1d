"""A folder that a sweep fills part by part, so that it goes on where it was ended."""

from __future__ import annotations

import dataclasses
import errno
import os
import pathlib
import typing

import numpy as np

from .. import _core, _data
from .._expression import refuse

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]
Columns = typing.Mapping[str, typing.Any]

#: First line of what says whose a folder is. Readers of tables (pyarrow, pandas) leave out files that begin with "_".
_FORM = "saltus sweep 1"
_STATEMENT, _JOURNAL, _LOCK = "_sweep.txt", "_parts.csv", "_lock"


@dataclasses.dataclass(frozen=True)
class Statement:
    """Which sweep a folder is of."""

    mark: str
    runs: int
    parts: int
    names: tuple[str, ...]
    kind: str = ""  # parquet or npz

    def text(self) -> str:
        lines = [_FORM, f"version {_core.version}", f"parts {self.kind}", f"sweep {self.mark}", f"runs {self.runs}"]
        return "\n".join([*lines, f"blocks {self.parts}", *(f"name {name}" for name in self.names), ""])


@dataclasses.dataclass(frozen=True)
class Part:
    """A file of consecutive runs, and what they came to."""

    number: int
    first: int
    last: int
    file: str
    bytes: int
    rows: int
    done: bool  # whether all of them did what was asked
    others: int  # of these the solution is not unique
    statuses: dict[str, int]

    def line(self) -> str:
        statuses = " ".join(f"{count} {status}" for status, count in self.statuses.items())
        numbers = (self.number, self.first, self.last, self.file, self.bytes, self.rows, int(self.done), self.others)
        return ",".join(map(str, (*numbers, statuses))) + "\n"

    @classmethod
    def of_line(cls, line: str) -> Part:
        number, first, last, file, size, rows, done, others, statuses = line.split(",")
        words = statuses.split()
        counts = dict(zip(words[1::2], map(int, words[::2])))
        return cls(int(number), int(first), int(last), file, int(size), int(rows), done == "1", int(others), counts)


class Folder:
    """The parts that are there, and where the next ones go. A part is there whole or not at all, whenever the process
    ends: it is written beside its place, and then noted in a journal."""

    def __init__(self, path: str | os.PathLike[str], wanted: Statement) -> None:
        """Opens a folder, or begins it where there is none, or an empty one. Raises :class:`ModelError`, and writes
        nothing, for a folder of another sweep or version, with other files, with a part that is not whole, and for one
        that another process fills."""
        if not isinstance(path, (str, os.PathLike)):
            raise TypeError(f"resume={path!r}: expected the name of a folder")
        self.path = pathlib.Path(path)
        self.statement = self._opened(wanted)
        self._lock = _Lock(self.path)
        self.parts: dict[int, Part] = {}
        try:
            self._read_journal()
        except BaseException:
            self.close()
            raise

    def _opened(self, wanted: Statement) -> Statement:
        file = self.path / _STATEMENT
        if not file.exists():
            if self.path.exists() and (not self.path.is_dir() or any(self.path.iterdir())):
                raise self._refused("there are other files, and no sweep", "name another folder, which may be a new one")
            statement = dataclasses.replace(wanted, kind="parquet" if _has_parquet() else "npz")
            try:
                self.path.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise self._refused(f"the folder cannot be made: {error.strerror}", "name another folder") from None
            _core.write_file(os.fspath(file), statement.text())
            return statement
        form, *lines = file.read_text(encoding="utf-8", errors="replace").splitlines() or [""]
        found = dict(line.split(" ", 1) for line in lines if " " in line)
        if form != _FORM or not {"version", "parts", "sweep", "runs", "blocks"} <= set(found):
            raise self._refused(f"{_STATEMENT} is no statement of a sweep", "name another folder")
        if found["parts"] == "csv":
            raise self._refused("a folder of the tool", f"go on with saltus sweep --resume {self.path}")
        if found["version"] != _core.version:
            raise self._refused(
                f"it was begun with version {found['version']} of saltus, this is {_core.version}",
                "digits may differ between versions: go on with that one, or name another folder",
            )
        if found["sweep"] != wanted.mark or found["runs"] != str(wanted.runs):
            raise self._refused(
                f"a folder of another sweep, of {found['runs']} runs: model, settings, values or keep differ",
                "name another folder, which may be a new one",
            )
        if found["parts"] == "parquet" and not _has_parquet():
            raise self._refused("its parts are Parquet, and pyarrow is not there", "pip install pyarrow")
        return dataclasses.replace(wanted, kind=found["parts"], parts=int(found["blocks"]))

    def _refused(self, why: str, remedy: str) -> Exception:
        return refuse(f"resume={os.fspath(self.path)!r}: {why}", remedy)

    def _read_journal(self) -> None:
        journal = self.path / _JOURNAL
        text = journal.read_bytes() if journal.exists() else b""
        whole = text[: text.rfind(b"\n") + 1]
        for number, line in enumerate(whole.decode("utf-8", "replace").splitlines(), 1):
            try:
                part = Part.of_line(line)
            except ValueError:
                raise self._refused(f"{_JOURNAL}, line {number}, says nothing of a part", "name another folder") from None
            file = self.path / part.file
            size = file.stat().st_size if file.exists() else None
            if size != part.bytes:
                is_now = "is not there" if size is None else f"has {size} bytes, expected {part.bytes}"
                raise self._refused(
                    f"{part.file} {is_now}: rows of the runs {part.first} to {part.last} are lost",
                    f"copy the file again, or remove line {number} of {_JOURNAL}, then these runs are run again",
                )
            self.parts[part.number] = part
        if whole != text:
            # A line that was half-written when the process was killed: its part is not noted, and is made again.
            with open(journal, "r+b") as file_of_lines:
                file_of_lines.truncate(len(whole))
        for left in self.path.glob(".part-*"):
            left.unlink()

    @property
    def missing(self) -> list[int]:
        """Numbers of the parts that are to be computed, from 1."""
        return [number for number in range(1, self.statement.parts + 1) if number not in self.parts]

    @property
    def ordered(self) -> list[Part]:
        return [part for _, part in sorted(self.parts.items())]

    @property
    def runs(self) -> int:
        """How many are there."""
        return sum(part.last - part.first + 1 for part in self.parts.values())

    def add(self, number: int, first: int, columns: Columns, tally: tuple[bool, int, dict[str, int]]) -> None:
        """Writes a part; it is there when this returns, whatever comes then."""
        done, others, statuses = tally
        last = first + sum(statuses.values()) - 1
        width = len(str(self.statement.runs))
        name = f"runs-{first:0{width}}-{last:0{width}}.{self.statement.kind}"
        columns = {column: _whole(column, values) for column, values in columns.items()}
        beside = self.path / f".part-{os.getpid()}-{name}"
        if self.statement.kind == "parquet":
            _write_parquet(beside, columns)
        else:
            _data.write_arrays(os.fspath(beside), columns)
        with open(beside, "rb+") as file:
            os.fsync(file.fileno())
        size = beside.stat().st_size
        os.replace(beside, self.path / name)
        rows = len(next(iter(columns.values())))
        part = Part(number, first, last, name, size, rows, done, others, statuses)
        # The line may be lost with the power: then the part is made again. That it says of a part is on the disk.
        with open(self.path / _JOURNAL, "ab") as journal:
            journal.write(part.line().encode())
        self.parts[number] = part

    def read(self, part: Part, names: typing.Sequence[str] | None = None) -> dict[str, Array]:
        """The table of a part, or some of its columns."""
        file = self.path / part.file
        if not file.exists():
            raise self._refused(f"{part.file} is not there any more", "the same call runs these runs again, without its line in " + _JOURNAL)
        if self.statement.kind == "parquet":
            import pyarrow.parquet

            table = pyarrow.parquet.read_table(file, columns=None if names is None else list(names), partitioning=None)
            return {name: _array(table.column(name)) for name in table.column_names}
        with np.load(file) as archive:
            return {name: archive[name] for name in (archive.files if names is None else names)}

    def columns(self, part: Part) -> list[str]:
        """The names of the columns of a part."""
        file = self.path / part.file
        if not file.exists():
            return []
        if self.statement.kind == "parquet":
            import pyarrow.parquet

            return list(pyarrow.parquet.read_schema(file).names)
        with np.load(file) as archive:
            return list(archive.files)

    def close(self) -> None:
        """Lets others fill the folder."""
        self._lock.close()


def _whole(name: str, values: typing.Any) -> Array:
    """Columns that count have whole numbers in every part; of others (modes) one part may have gaps."""
    column = np.asarray(values)
    return column.astype(np.int64) if name in ("run", "unique", "events", "event") else column


def _has_parquet() -> bool:
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        return False
    return True


def _write_parquet(file: pathlib.Path, columns: Columns) -> None:
    import pyarrow
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.table({name: np.asarray(values) for name, values in columns.items()}), file)


def _array(column: typing.Any) -> Array:
    values: Array = column.to_numpy()
    return values.astype(str) if values.dtype == object else values


#: Folders that this process fills: locks of a file keep others out only.
_FILLED: set[str] = set()


class _Lock:
    """Nobody else fills the folder until this is closed, or the process ends, however it does. Of POSIX locks: workers
    that are forked meanwhile, and outlive a process that is killed, do not have them."""

    def __init__(self, path: pathlib.Path) -> None:
        self._name, self._file = os.path.realpath(path), open(path / _LOCK, "a+b")
        if self._name in _FILLED or not self._is_ours():
            self._file.close()
            raise refuse(f"resume={os.fspath(path)!r}: another sweep fills this folder", "wait for it, or end its process")
        _FILLED.add(self._name)

    def _is_ours(self) -> bool:
        try:
            import fcntl
        except ImportError:  # no Unix
            return True
        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            return error.errno not in (errno.EACCES, errno.EAGAIN)  # else a file system without locks
        return True

    def close(self) -> None:
        _FILLED.discard(self._name)
        self._file.close()

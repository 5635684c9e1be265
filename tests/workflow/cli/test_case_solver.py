"""Tables solved in blocks: the bits of one pass, the first row at fault by its line, a bound on the answer."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from solver import solve
from storage.netcdf import read_whole, write_whole
from workflow.cli import main
from workflow.cli import solve as case_solver
from workflow.cli.casetable import read_cases
from workflow.language.wordings import plain
from workflow.study.reading import InputError

# sorted, so that blocks of neighbours would take the solver other numbers of steps
SORTED = "".join(f"laminate,{share:.6g},,0.05,{friction},1e5\n" for share, friction in
                 zip(np.linspace(0, 1, 300) ** 4, np.linspace(0, 1, 300), strict=True))  # fmt: skip
OTHERS = "".join(f",,{name},0.02,0.3,{load}\n" for name in ("steel", "PZT-4", "BaTiO3") for load in range(1, 41))


def test_blocks_give_the_bytes_of_one_pass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "cases.csv"
    path.write_text("composite,volume_fraction,material,radius,friction,load\n" + SORTED + OTHERS, encoding="utf-8")
    sizes: list[int] = []

    def written(most: int) -> bytes:
        monkeypatch.setattr(case_solver, "_CLOSED", most)
        sizes.clear()

        def counted(factors: xr.Dataset) -> xr.Dataset:
            sizes.append(factors.sizes["case"])
            return solve(factors, [-2.0, 0.5])

        write_whole(case_solver.solved(read_cases(path), counted, 2), tmp_path / f"{most}.nc")
        return (tmp_path / f"{most}.nc").read_bytes()

    one_pass = written(1000)
    assert sizes == [300, 120]
    assert written(70) == one_pass
    assert sizes == [60] * 7
    data = read_whole(tmp_path / "70.nc")
    assert data["load"].sizes == {"case": 420}
    np.testing.assert_array_equal(data["load"].values[300:], np.tile(np.arange(1.0, 41.0), 3))


#: A row of every column that the cases below change.
ROW = {
    "composite": "", "volume_fraction": "0.5", "material": "", "radius": "0.05", "friction": "0.1", "load": "1e5",
    "surroundings": "", "electric": "", "magnetic": "",
}  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"volume_fraction": "1.5"}, "volume_fraction: 1.5 is not a finite number >= 0 and <= 1"),
        ({"volume_fraction": "", "material": "stel"}, "material: 'stel' is unknown; did you mean 'steel'?"),
        ({"radius": "-1"}, "radius: -1 is not a finite number > 0"),
        ({"load": ""}, "load: missing"),
        ({"radius": "1e300", "load": "1e300"}, "not finite for these factors"),
        ({"surroundings": "air", "electric": "insulating", "magnetic": "insulating"}, "the punch conducts no field"),
    ],
)
def test_a_row_at_fault_is_named_by_its_line(tmp_path: Path, changed: dict[str, str], says: str) -> None:
    path = tmp_path / "cases.csv"
    header, good, bad = (",".join(row) + "\n" for row in (ROW, ROW.values(), (ROW | changed).values()))
    path.write_text(header + "\n" + good * 9 + bad + good * 9 + bad, encoding="utf-8")
    with pytest.raises(InputError, match=rf"^{path}: line 12: .*{re.escape(says)}"):
        case_solver.solved(read_cases(path), solve)


def test_a_long_table_is_answered_in_blocks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A later block has columns and faults of its own; the file is that of one table, or none."""
    path = tmp_path / "cases.csv"
    header, *rows = "material,radius,load,profile,width", "PZT-4,0.05,1e4 N/m,,", "steel,,2e4 N/m,flat,1e-3"
    path.write_text("\n".join([header, *[rows[0]] * 7, *[rows[1]] * 5, *[rows[0]] * 2]) + "\n", encoding="utf-8")
    assert main.main(["solve", str(path), "-o", str(tmp_path / "whole.csv")]) == 0
    said = capsys.readouterr().err.replace("whole", "blocks")
    monkeypatch.setattr(case_solver, "_BLOCK", 4)
    assert main.main(["solve", str(path), "-o", str(tmp_path / "blocks.csv")]) == 0
    assert capsys.readouterr().err == said
    whole, blocks = (pd.read_csv(tmp_path / f"{name}.csv") for name in ("whole", "blocks"))
    pd.testing.assert_frame_equal(blocks[whole.columns], whole, rtol=1e-12)
    path.write_text(path.read_text(encoding="utf-8") + "PZT-4,-1,1e4 N/m,,\n", encoding="utf-8")
    (tmp_path / "blocks.csv").unlink()
    assert main.main(["solve", str(path), "-o", str(tmp_path / "blocks.csv")]) == 2
    assert "line 16: radius: -1 is not a finite number > 0" in capsys.readouterr().err
    assert {file.name for file in tmp_path.iterdir()} == {"cases.csv", "whole.csv"}


def test_an_answer_too_large_for_the_memory_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "cases.csv"
    path.write_text("material,radius,load\n" + "steel,0.05,1e5\n" * 50, encoding="utf-8")
    monkeypatch.setattr(case_solver, "_MOST_BYTES", 5000)
    with pytest.raises(InputError, match=r"cases\.csv: 50 cases give .* bytes, more than 5000; split it"):
        case_solver.solved(read_cases(path), solve)


def test_a_name_that_a_spreadsheet_would_calculate_stays_a_name() -> None:
    frame = xr.Dataset(coords={"material": ("case", np.array(["=1+1"], dtype=object))})
    assert case_solver._as_rows(frame, ["material"]) == "'=1+1\n"
    assert [plain(text) for text in ("=1+1", "+x", "-x", "@x")] == ["'=1+1", "'+x", "'-x", "'@x"]
    assert [plain(cell) for cell in ("a,b", -1.0)] == ["a,b", -1.0]

"""The battery's table: what is written is read back the same, and a stranger's is read or refused in a line."""

import csv
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from babbling.errors import BabblingError
from experiments.battery.reading import NEEDED, read
from experiments.battery.table import IMITATOR, MEANING, WHOLE, Trial, dictionary, joined, tidy
from models.errors import BodyError
from tests.tables import write

TASK = 'dumbbell, "large"'


@pytest.fixture
def frame() -> pd.DataFrame:
    trials = [
        Trial(
            agent=agent, seed=agent % 2, without=WHOLE, who=IMITATOR, stage=4, task=TASK, condition=shown,
            trial=trial, response="pull", target="pull", hit=float("nan") if trial else 1.0, value=0.1 * trial / 3,
            unit="deg", options="pull|leave", likelihood=joined([0.3, 0.7]),
        )
        for agent in range(4) for shown in ("failed", "done") for trial in range(3)
    ]  # fmt: skip
    return tidy(trials, {agent: {"memory": agent / 3, "rule": f"rule {agent}"} for agent in range(4)})


@pytest.mark.parametrize("name", ["trials.csv", "trials.parquet"])
def test_what_is_written_is_read_back_the_same(name: str, frame: pd.DataFrame, tmp_path: Path) -> None:
    write(frame, tmp_path)
    pd.testing.assert_frame_equal(read(tmp_path / name), frame)


def test_the_text_is_rfc_4180_and_nothing_is_empty(frame: pd.DataFrame, tmp_path: Path) -> None:
    write(frame, tmp_path)
    content = (tmp_path / "trials.csv").read_bytes().decode("utf-8")
    assert content.count("\r\n") == content.count("\n") == len(frame) + 1
    rows = list(csv.DictReader(StringIO(content, newline="")))
    assert [row["hit"] for row in rows] == ["" if np.isnan(hit) else "1.0" for hit in frame["hit"]]
    assert rows[0]["task"] == TASK and rows[0]["prior"] == ""


def test_the_dictionary_tells_of_every_column(frame: pd.DataFrame) -> None:
    found = dictionary(frame, {"memory": "Acts it remembers."}).set_index("column")
    assert list(found.index) == list(frame.columns)
    assert found["meaning"].str.len().min() > 5
    assert found.loc["memory", "meaning"] == "Acts it remembers." and found.loc["rule", "meaning"]
    assert found.loc["options", "meaning"] == "Responses that were possible, joined by `|`."
    assert found.loc["condition", "values"] == "done, failed" and found.loc["agent", "type"] == "whole number"
    assert found.loc["agent", "values"] == "0, 1, 2, 3" and found.loc["task", "type"] == "text"
    many = pd.concat([frame.assign(agent=number) for number in range(20)])
    assert dictionary(many).set_index("column").loc["agent", "values"] == "0 to 19"


def test_a_strangers_infants_may_have_names_and_little_else(tmp_path: Path) -> None:
    path = tmp_path / "infants.csv"
    path.write_text("agent;task;condition;trial;response;age\nP01;cup;shown;0;lift;14,5\nP02;cup;shown;0;push;NA\n")
    found = read(path)
    assert found["agent"].tolist() == ["P01", "P02"] and found["trial"].tolist() == [0, 0]
    assert found["age"].iloc[0] == 14.5 and np.isnan(found["age"].iloc[1])


def test_needed_columns_are_columns() -> None:
    assert set(NEEDED) < set(MEANING)


HEAD = "agent,task,condition,trial,response,hit\n"
ROW = "1,cup,shown,0,lift,1\n"
TEXTS = {
    "no column": ("a,b\n1,2\n", "columns missing: agent, task, condition, trial, response; .*there are a, b"),
    "one missing": (HEAD.replace("response", "Response") + ROW, "columns missing: response; "),
    "no rows": (HEAD, "no row"),
    "twice": (HEAD + ROW + ROW, "agent 1, task cup, condition shown, trial 0 stands there twice"),
    "one name": (HEAD.replace("hit", "task") + ROW, "two columns are called task"),
    "part of a trial": (HEAD + ROW.replace(",0,", ",0.5,"), "line 2, trial: '0.5' is no whole number"),
    "beyond all": (HEAD + ROW.replace(",0,", ",1e30,"), "line 2, trial: '1e30' is no whole number"),
    "no trial": (HEAD + ROW.replace(",0,", ",,"), "line 2, trial: '' is no whole number"),
    "half a hit": (HEAD + ROW.replace("lift,1", "lift,0.5"), "hit: only 0, 1 and nothing"),
    "a word": (HEAD + ROW.replace("lift,1", "lift,often"), "line 2, hit: 'often' is not a finite number"),
    "endless": (HEAD + ROW.replace("lift,1", "lift,inf"), "hit: 'inf' is not a finite number"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_that_is_no_table_is_a_line(name: str, tmp_path: Path) -> None:
    content, said = TEXTS[name]
    (path := tmp_path / "infants.csv").write_text(content)
    with pytest.raises((BabblingError, BodyError), match=said) as caught:
        read(path)
    assert "\n" not in str(caught.value) and path.name in str(caught.value)


def changed(**columns: Any) -> Callable[[pa.Table], pa.Table]:
    return lambda table: pa.table({name: table[name] for name in table.column_names} | columns)


ROWS = 24
PARQUETS: dict[str, tuple[Callable[[pa.Table], pa.Table], str]] = {
    "lists": (changed(more=[[1]] * ROWS), "more: holds list<.*only numbers and text"),
    "bytes": (changed(more=[b"a"] * ROWS), "more: holds binary"),
    "times": (changed(more=pa.array([0] * ROWS, pa.timestamp("s"))), "more: holds timestamp"),
    "nothing": (lambda table: table.drop_columns(["trial"]), "columns missing: trial"),
    "long": (lambda table: pa.table({"agent": pa.array(np.zeros(6_000_000, np.int8))}), "6000000 rows"),
    "one name": (lambda table: table.rename_columns(["x", "x", *table.column_names[2:]]), "the same name"),
}


@pytest.mark.parametrize("name", PARQUETS)
def test_a_parquet_of_something_else_is_a_line(name: str, frame: pd.DataFrame, tmp_path: Path) -> None:
    change, said = PARQUETS[name]
    table = pa.Table.from_pandas(frame, preserve_index=False)
    pq.write_table(change(table), path := tmp_path / "trials.parquet")
    with pytest.raises((BabblingError, BodyError), match=said) as caught:
        read(path)
    assert "\n" not in str(caught.value) and path.name in str(caught.value)


def test_flags_categories_and_gaps_of_a_parquet_are_read(frame: pd.DataFrame, tmp_path: Path) -> None:
    told = frame.assign(rule=frame["rule"].astype("category"), twin=frame["agent"] > 1)
    told.loc[0, "value"] = None
    told.to_parquet(path := tmp_path / "trials.parquet")
    found = read(path)
    assert found["rule"].tolist() == frame["rule"].tolist() and set(found["twin"]) == {"True", "False"}
    assert np.isnan(found["value"][0]) and found["value"][1:].tolist() == frame["value"][1:].tolist()


@pytest.mark.parametrize("name", ["trials.csv", "trials.parquet"])
def test_a_damaged_file_is_read_or_refused_in_a_line(name: str, frame: pd.DataFrame, tmp_path: Path) -> None:
    write(frame, tmp_path)
    good, rng, refused = (tmp_path / name).read_bytes(), np.random.default_rng(0), 0
    for case in range(60):
        content = bytearray(good[: rng.integers(1, len(good))] if case % 3 == 0 else good)
        for place in rng.integers(0, len(content), 4):
            content[place] ^= int(rng.integers(1, 256))
        (path := tmp_path / f"{case}{name}").write_bytes(bytes(content))
        try:
            read(path)
        except (BabblingError, BodyError) as error:
            refused += 1
            assert str(error).isprintable() and path.name in str(error)
    assert refused > 20

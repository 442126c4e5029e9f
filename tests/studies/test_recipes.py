"""The page on studies: its programs compile, its cluster is one that Dask's commands understand, its study is read."""

from __future__ import annotations

import ast
import re
import tomllib
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import pytest
import yaml

import trunnion as tn
from trunnion.studies.description import as_description

PAGE = (Path(__file__).parents[2] / "docs" / "studies.md").read_text(encoding="utf-8")
# What dask-jobqueue 0.9 takes for Slurm, of what a recipe may need.
OF_SLURM = {"queue", "account", "walltime", "cores", "processes", "memory", "job_cpu", "job_mem", "interface"}
OF_SLURM |= {"job_extra_directives", "job_script_prologue", "local_directory", "log_directory", "python"}


def blocks(language: str) -> list[str]:
    """Fenced blocks of the page."""
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_slurm() -> None:
    (program,) = (one for one in blocks("python") if "dask_jobqueue" in one)
    tree = ast.parse(program)
    calls = [one for one in ast.walk(tree) if isinstance(one, ast.Call)]
    (made,) = (one for one in calls if ast.unparse(one.func) == "SLURMCluster")
    stated = {one.arg: ast.literal_eval(one.value) for one in made.keywords}
    assert set(stated) <= OF_SLURM
    assert stated["processes"] == stated["cores"], "one thread each"
    assert "OMP_NUM_THREADS=1" in " ".join(stated["job_script_prologue"])
    (asked,) = (one for one in calls if ast.unparse(one.func) == "tn.study")
    assert [one.arg for one in asked.keywords] == ["client"] and callable(tn.study)
    compile(tree, "recipe", "exec")


def arguments_of(container: dict[str, Any]) -> dict[str, Any]:
    """What the program of a container understands of its arguments."""
    program, name, *rest = container["args"]
    assert program in {one.name for one in entry_points(group="console_scripts")}
    (command,) = (one.load() for one in entry_points(group="dask_cli") if one.name == name)
    return dict(command.make_context(name, list(rest)).params)


def test_kubernetes() -> None:
    (text,) = blocks("yaml")
    cluster = yaml.safe_load(text)
    assert (cluster["apiVersion"], cluster["kind"]) == ("kubernetes.dask.org/v1", "DaskCluster")
    name, spec = cluster["metadata"]["name"], cluster["spec"]
    assert set(spec) == {"worker", "scheduler"}
    (one,) = spec["worker"]["spec"]["containers"]
    asked = arguments_of(one)
    assert asked["nthreads"] == 1 and asked["n_workers"] == "16"
    volumes = {volume["name"] for volume in spec["worker"]["spec"]["volumes"]}
    assert {mount["name"] for mount in one["volumeMounts"]} <= volumes
    (one,) = spec["scheduler"]["spec"]["containers"]
    arguments_of(one)
    service = spec["scheduler"]["service"]
    ports = {port["name"]: port["containerPort"] for port in one["ports"]}
    assert all(port["targetPort"] in ports for port in service["ports"])
    assert service["selector"]["dask.org/cluster-name"] == name
    assert f"tcp://{name}-scheduler:{ports['tcp-comm']}" in PAGE.replace("\n", "").replace("  ", " ")


def test_a_wrong_recipe_would_be_seen() -> None:
    with pytest.raises(Exception, match="extra argument"):
        arguments_of({"args": ["dask", "worker", "--nproc", "16"]})


def test_the_studies_of_the_page() -> None:
    for text in blocks("toml"):
        assert as_description(tomllib.loads(text)) is not None

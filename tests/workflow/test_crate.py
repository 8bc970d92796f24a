"""`snakemake crate` packs a finished run with what made it, as RO-Crate asks for."""

import hashlib
import json
import zipfile
from pathlib import Path

import pytest
from rocrate.rocrate import ROCrate

from visuohaptic_workflow.crate import write_crate

pytestmark = [pytest.mark.workflow, pytest.mark.long]
METADATA = "ro-crate-metadata.json"


@pytest.fixture(scope="module")
def crate(finished, tmp_path_factory):
    """The experiment with its crate."""
    experiment = finished.copy(tmp_path_factory.mktemp("crate") / "experiment")
    experiment.snakemake("crate")
    return experiment


@pytest.fixture(scope="module")
def archive(crate):
    return zipfile.ZipFile(crate.folder / "reports/crate.zip")


@pytest.fixture(scope="module")
def entities(archive):
    """What the crate describes, by name."""
    graph = json.loads(archive.read(METADATA))["@graph"]
    assert len({entity["@id"] for entity in graph}) == len(graph)
    return {entity["@id"]: entity for entity in graph}


def references(value):
    """Give every name that an entity refers to."""
    items = value if isinstance(value, list) else [value]
    return [item["@id"] for item in items if isinstance(item, dict)]


def test_every_file_of_the_archive_is_described_with_its_size_and_hash(archive, entities):
    names = set(archive.namelist()) - {METADATA}
    assert names == {name for name, one in entities.items() if "File" in one["@type"]} - {METADATA}
    for name in names - {"workflow/Snakefile"}:
        content = archive.read(name)
        assert entities[name]["contentSize"] == str(len(content))
        assert entities[name]["sha256"] == hashlib.sha256(content).hexdigest()
    assert entities["reports/metrics.json"]["encodingFormat"] == "application/json"


def test_what_an_entity_refers_to_is_described_in_the_crate(crate, entities):
    for entity in entities.values():
        for name in (found for value in entity.values() for found in references(value)):
            assert name in entities or name.startswith("https://"), (entity["@id"], name)
    read = ROCrate(crate.folder / "reports/crate.zip")
    assert read.mainEntity.id == "workflow/Snakefile"


def test_the_root_says_what_it_is_and_which_profile_it_follows(entities):
    root = entities["./"]
    assert {"name", "description", "datePublished", "license", "hasPart"} <= set(root)
    assert "https://w3id.org/ro/wfrun/workflow/0.5" in references(root["conformsTo"])
    main = entities[root["mainEntity"]["@id"]]
    assert {"File", "SoftwareSourceCode", "ComputationalWorkflow"} <= {*main["@type"]}
    assert entities[main["programmingLanguage"]["@id"]]["name"] == "Snakemake"


def test_the_run_has_parameters_and_all_results_of_the_finished_run(crate, finished, entities):
    (run,) = (entity for entity in entities.values() if "CreateAction" in entity["@type"])
    assert references(run["instrument"]) == ["workflow/Snakefile"]
    given = [entities[name] for name in references(run["object"])]
    parameters = {one["name"]: one["value"] for one in given}
    assert json.loads(parameters["viewpoints"])["count"] == 2
    files = (finished.folder / "results").glob("[!s]*/**/*.parquet")
    tables = {str(file.relative_to(finished.folder)) for file in files}
    expected = {*tables, "reports/report.html", "results/records/report.json"}
    assert expected <= set(references(run["result"]))
    assert crate.planned() == {}


def test_a_pack_that_is_stopped_leaves_the_old_archive_and_no_other_file(tmp_path, monkeypatch):
    def stop(_, path):
        Path(path).write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(ROCrate, "write_zip", stop)
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text("{}")
    archive = tmp_path / "reports/crate.zip"
    archive.parent.mkdir()
    archive.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt):
        write_crate(archive, Path(__file__).parents[2], ["a.json"], {}, "none")
    assert [file.name for file in archive.parent.iterdir()] == ["crate.zip"]
    assert archive.read_bytes() == b"old"

"""Results travel through S3: Snakemake's jobs keep them there, and DVC brings them to a colleague.

The S3 is moto's server, in this process, on the loopback.
"""

import re
from dataclasses import replace

import boto3
import pytest
from golden import golden_tables, run_tables
from moto.server import ThreadedMotoServer
from workflow.stand_ins import digests

pytestmark = [pytest.mark.workflow, pytest.mark.long]

SECTION = re.compile(r'<section id="([a-z-]+)"')


@pytest.fixture
def address(monkeypatch, tmp_path):
    """The address of a server with a bucket named `bucket`."""
    # What this machine's user has for a real S3 stays out.
    nothing = tmp_path / "nothing"
    nothing.touch()
    for name, value in {
        "ACCESS_KEY_ID": "name", "SECRET_ACCESS_KEY": "secret", "DEFAULT_REGION": "us-east-1",
        "EC2_METADATA_DISABLED": "true", "CONFIG_FILE": nothing, "SHARED_CREDENTIALS_FILE": nothing,
    }.items():  # fmt: skip
        monkeypatch.setenv(f"AWS_{name}", str(value))
    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    boto3.client("s3", endpoint_url=f"http://{host}:{port}").create_bucket(Bucket="bucket")
    yield f"http://{host}:{port}"
    server.stop()


def test_results_on_s3_of_other_blocks_and_one_process_are_those_of_a_local_run(
    fresh, finished, open_folder, address, tmp_path
):
    experiment = open_folder(fresh.copy(tmp_path / "experiment").folder, has_stand_ins=False)
    on_s3 = (
        "--default-storage-provider", "s3", "--default-storage-prefix", "s3://bucket/run",
        "--storage-s3-endpoint-url", address,
    )  # fmt: skip
    experiment.set(workflow={"views_per_job": 1, "objects_per_job": 4})
    experiment.run("snakemake", "-j1", *on_s3)
    assert not list((experiment.folder / "results").rglob("*.parquet"))
    bucket = boto3.resource("s3", endpoint_url=address).Bucket("bucket")
    found = tmp_path / "found"
    for one in bucket.objects.filter(Prefix="run/"):
        file = found / one.key.removeprefix("run/")
        file.parent.mkdir(parents=True, exist_ok=True)
        bucket.download_file(one.key, str(file))
    there, here = (run_tables.read_run(run) for run in (found, finished.folder))
    # These have a row for each block of viewpoints, or draw touches from each.
    differ = golden_tables.differences(golden_tables.kept_of(here), there)
    assert differ.keys() == {"effects", "effect_influence"}
    pages = [(run / "reports/report.html").read_text() for run in (found, finished.folder)]
    assert "Settings measured in this run" in pages[0]
    assert SECTION.findall(pages[0]) == SECTION.findall(pages[1])
    assert "Nothing to be done" in experiment.snakemake("-n", *on_s3).stdout


def test_a_colleague_gets_results_by_dvc_from_s3_and_finds_nothing_left_to_do(
    repository, address, tmp_path
):
    shared = repository.copy(tmp_path / "shared")
    shared.run("dvc", "remote", "add", "--default", "team", "s3://bucket/visuohaptic")
    shared.run("dvc", "remote", "modify", "team", "endpointurl", address)
    shared.run("git", "commit", "-qam", "name the remote")
    shared.run("dvc", "push")
    shared.run("git", "clone", "-q", str(shared.folder), str(tmp_path / "clone"))
    clone = replace(shared, folder=tmp_path / "clone")
    clone.run("dvc", "pull")
    assert digests(clone.folder) == digests(shared.folder)
    assert clone.planned() == {}
    assert "up to date" in clone.run("dvc", "status").stdout

"""Results travel through S3: Snakemake's jobs keep them there, and DVC brings them to a colleague.

The S3 is moto's server, in this process, on the loopback.
"""

import re

import pytest

pytestmark = [pytest.mark.workflow, pytest.mark.long]


class Bucket:
    """A bucket of a server on this machine."""

    def __init__(self, address):
        import boto3

        self.address = address
        self.client = boto3.client("s3", endpoint_url=address)
        self.client.create_bucket(Bucket="bucket")

    def keys(self, prefix):
        """List what the bucket holds below a prefix."""
        pages = self.client.get_paginator("list_objects_v2").paginate(
            Bucket="bucket", Prefix=f"{prefix}/"
        )
        return [entry["Key"] for page in pages for entry in page.get("Contents", [])]

    def download(self, prefix, folder):
        """Write what the bucket holds below a prefix into a folder."""
        for key in self.keys(prefix):
            file = folder / key.removeprefix(f"{prefix}/")
            file.parent.mkdir(parents=True, exist_ok=True)
            self.client.download_file("bucket", key, str(file))


@pytest.fixture
def bucket(monkeypatch, tmp_path):
    from moto.server import ThreadedMotoServer

    # What this machine's user has for a real S3 stays out.
    nothing = tmp_path / "nothing"
    nothing.touch()

    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "name")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    monkeypatch.setenv("AWS_CONFIG_FILE", str(nothing))
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(nothing))
    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    yield Bucket(f"http://{host}:{port}")
    server.stop()


def without_seconds(experiment):
    """Give the SHA-256 of every result that holds no measured seconds."""
    timed = ("frontier", "effect_influence")
    return {
        name: digest
        for name, digest in experiment.digests().items()
        if not any(word in name for word in timed)
    }


def test_results_that_snakemake_keeps_on_s3_are_those_of_a_local_run(
    fresh, finished, bucket, tmp_path
):
    experiment = fresh.copy(tmp_path / "experiment")
    on_s3 = (
        "--default-storage-provider", "s3", "--default-storage-prefix", "s3://bucket/run",
        "--storage-s3-endpoint-url", bucket.address,
    )  # fmt: skip
    experiment.snakemake(*on_s3)
    assert not list((experiment.folder / "results").rglob("*.parquet"))
    found = type(fresh)(tmp_path / "found")
    bucket.download("run", found.folder)
    assert without_seconds(found) == without_seconds(finished)
    there, here = ((run.folder / "reports/report.html").read_text() for run in (found, finished))
    assert "Settings measured in this run" in there
    sections = re.compile(r'<section id="([a-z-]+)"')
    assert sections.findall(there) == sections.findall(here)
    assert "Nothing to be done" in experiment.snakemake("-n", *on_s3).stdout


def test_a_colleague_gets_results_by_dvc_from_s3_and_finds_nothing_left_to_do(
    repository, bucket, tmp_path
):
    shared = repository.copy(tmp_path / "shared")
    shared.run("dvc", "remote", "add", "--default", "team", "s3://bucket/visuohaptic")
    shared.run("dvc", "remote", "modify", "team", "endpointurl", bucket.address)
    shared.run("git", "commit", "-qam", "name the remote")
    shared.run("dvc", "push")
    shared.run("git", "clone", "-q", str(shared.folder), str(tmp_path / "clone"))
    clone = type(shared)(tmp_path / "clone")
    clone.run("dvc", "pull")
    assert clone.digests() == shared.digests()
    assert clone.planned() == {}
    assert "up to date" in clone.run("dvc", "status").stdout

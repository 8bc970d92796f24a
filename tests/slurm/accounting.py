"""What keeps a cluster's accounting: slurmdbd from Debian and a MariaDB of its own, both on the loopback."""

from __future__ import annotations

import secrets
from pathlib import Path

PROGRAMS = ("slurmdbd", "sacct", "sacctmgr", "mariadbd", "mariadb-install-db", "my_print_defaults")
PACKAGES = ("slurmdbd", "mariadb-server-core", "mariadb-client-core")
ACCOUNT = "loopback"

# With these lines only users of a known account may submit.
CLUSTER_LINES = """\
AccountingStorageType=accounting_storage/slurmdbd
AccountingStorageHost=127.0.0.1
AccountingStoragePort={port}
AccountingStoragePass={folder}/munge.socket
AccountingStorageEnforce=associations
JobAcctGatherType=jobacct_gather/linux
"""
NO_ACCOUNTING = """\
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
"""
_KEEPER = """\
DbdHost={host}
DbdAddr=127.0.0.1
DbdPort={port}
SlurmUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StorageType=accounting_storage/mysql
StorageHost=127.0.0.1
StoragePort={database_port}
StorageUser=slurm
StoragePass={password}
StorageLoc=slurm
PidFile={folder}/slurmdbd.pid
LogFile={folder}/slurmdbd.log
"""
_DATABASE = """\
CREATE DATABASE slurm;
CREATE USER 'slurm'@'127.0.0.1' IDENTIFIED BY '{password}';
GRANT ALL ON slurm.* TO 'slurm'@'127.0.0.1';
"""


def write_configuration(
    folder: Path, host: str, user: str, port: int, database_port: int
) -> dict[str, list[str]]:
    """Write what both daemons need into the cluster's folder, and give the options of each.

    Parameters
    ----------
    folder : path
        The cluster's.
    host, user : str
        Name of the node and of the user who runs all daemons.
    port, database_port : int
        Free ports for slurmdbd and MariaDB.

    Returns
    -------
    dict of list of str
        By daemon, in the order in which they start.
    """
    password = secrets.token_hex(16)
    settings = {"folder": folder, "host": host, "user": user, "port": port}
    secret_files = {
        "slurmdbd.conf": _KEEPER.format(**settings, database_port=database_port, password=password),
        "database.sql": _DATABASE.format(password=password),
    }
    for name, text in secret_files.items():
        (folder / name).touch(mode=0o600)
        (folder / name).write_text(text, encoding="utf-8")
    return {
        "mariadbd": [
            "--no-defaults", f"--datadir={folder / 'database'}", f"--socket={folder / 'database.socket'}",
            f"--pid-file={folder / 'database.pid'}", "--bind-address=127.0.0.1", f"--port={database_port}",
            "--skip-name-resolve", f"--init-file={folder / 'database.sql'}", f"--user={user}",
        ],
        "slurmdbd": ["-D"],
    }  # fmt: skip


def installation(folder: Path, user: str) -> list[str]:
    """Give the command that makes an empty database in the cluster's folder."""
    return [
        "mariadb-install-db", "--no-defaults", f"--datadir={folder / 'database'}",
        "--auth-root-authentication-method=normal", "--skip-test-db", f"--user={user}",
    ]  # fmt: skip

"""The phases of an object, file to file, as the workflow's jobs run them."""

from visuohaptic.io.phase_files import SCHEMAS, run_phase_on_files
from visuohaptic.phases import OF_OBJECT
from visuohaptic.pipeline import WORK
from visuohaptic.tables.schema import read_table


def run_phases(key, mesh, folder, parameters, viewpoints=None, phases=OF_OBJECT):
    """Take one object through phases; give their tables, read back and checked."""
    numbers = range(parameters.viewpoints.total) if viewpoints is None else viewpoints
    found = {}
    for phase in phases:
        outputs = {table: folder / f"{place}.parquet" for table, place in phase.writes.items()}
        run_phase_on_files(
            work=WORK[phase.name],
            arguments=phase.written_values(parameters),
            meshes={key: mesh},
            inputs={table: folder / f"{table}.parquet" for table in phase.input_tables},
            outputs=outputs,
            viewpoints=numbers,
        )
        for table, place in phase.writes.items():
            found[place] = read_table(SCHEMAS[table], outputs[table])
    return found

"""The schemas of all tables by name."""

from visuohaptic.tables.phases import PHASES
from visuohaptic.tables.pictures import PICTURES
from visuohaptic.tables.stability import STABILITY
from visuohaptic.tables.studies import STUDIES

SCHEMAS = {schema.name: schema for schema in (*PHASES, STABILITY, PICTURES, *STUDIES)}

"""The section of the report on the kept draws of random places."""

from __future__ import annotations

from collections.abc import Iterator

from draws.kept import kept_sentence, read_draws
from draws.study import STUDY
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext, sentences_section


def sentences(context: ReportContext) -> Iterator[str]:
    """Yield one sentence per pipeline of the run with kept draws on the set of the run."""
    for table in context.run.pipelines:
        kept = read_draws(context.run.parameters.meshes.set, table.name)
        if kept is not None:
            yield kept_sentence(kept)


SECTION = sentences_section(STUDY.name, "Further draws of random places", sentences, OTHER_OBJECTS)

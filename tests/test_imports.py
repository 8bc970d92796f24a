"""Modules of the package import each other in one direction."""

from graphlib import TopologicalSorter

import grimp


def test_no_module_imports_itself_through_others_not_even_for_the_type_checker():
    graph = grimp.build_graph("visuohaptic", cache_dir=None)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert list(TopologicalSorter(imports).static_order())  # raises CycleError otherwise

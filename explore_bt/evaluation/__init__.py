"""How good a trajectory is, by the field's own measures."""

from explore_bt.evaluation.relations import (
    Relation,
    RelationErrors,
    read_relations,
    relation_errors,
)

__all__ = ["Relation", "RelationErrors", "read_relations", "relation_errors"]

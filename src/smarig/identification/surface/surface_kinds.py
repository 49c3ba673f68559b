"""The list of the kinds of surface that can be identified: the forms of (5.5), a positive measure, and a table."""

from itertools import groupby

from smarig.core import catalogue_names

POSITIVE_KIND = "positive"
TABLE_KIND = "table"
BEST_KIND = "best"  # the kind that predicts held-out curves best
_FORMS = "smarig.preisach.hysteresis.forms"


def surface_choices() -> tuple[str, ...]:
    """The kinds and "best", by name; unlike ``surface_kinds`` without importing the forms.

    >>> surface_choices()
    ('constant', 'exponential', 'parabolic', 'positive', 'table', 'best')
    """
    return *catalogue_names(_FORMS), POSITIVE_KIND, TABLE_KIND, BEST_KIND


def kinds_by_freedom() -> tuple[tuple[str, ...], ...]:
    """The kinds in levels of rising freedom; forms with equally many parameters share a level.

    >>> kinds_by_freedom()
    (('constant',), ('parabolic', 'exponential'), ('positive',), ('table',))
    """
    from smarig.preisach import surface_forms

    by_parameters = groupby(surface_forms().items(), key=lambda item: len(item[1].parameters))
    return (
        *(tuple(name for name, _ in level) for _, level in by_parameters),
        (POSITIVE_KIND,),
        (TABLE_KIND,),
    )


def surface_kinds() -> tuple[str, ...]:
    """The kinds by rising freedom."""
    return tuple(kind for level in kinds_by_freedom() for kind in level)

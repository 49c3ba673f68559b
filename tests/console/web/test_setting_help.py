"""Every setting of every protocol is explained to the person who fills in the form, and nothing else is."""

from smarig.console.web.protocol_form import SETTING_HELP, protocol_form
from smarig.core import catalogue_names, own_entries
from smarig.protocols import PROTOCOLS


def test_every_setting_has_a_sentence_and_every_sentence_a_setting():
    shipped = set(catalogue_names(PROTOCOLS)) - set(own_entries(PROTOCOLS))  # other tests load their own
    fields = [field for name in shipped for field in protocol_form(name)]
    assert {field.key for field in fields} == set(SETTING_HELP)
    assert [field.key for field in fields if not field.help.endswith(".")] == []

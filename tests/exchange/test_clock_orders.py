"""Dates keep one order in a column: the one that all rows allow and in which time goes forward."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.exchange.text.clock_cells import clock_column


def seconds(path, cells):
    return clock_column(path, "stamp", cells, range(1, len(cells) + 1))


@pytest.mark.parametrize(
    ("cells", "days"),
    [
        (["4/12/2021 23:59:59", "4/13/2021 00:00:01"], 2 / 86400),  # the first row allows two orders
        (["12/4/2021 23:59:59", "13/4/2021 00:00:01"], 2 / 86400),
        (["01/02/21 11:59:58 PM", "01/03/21 12:00:00 AM"], 2 / 86400),  # both orders read all: the sooner
        (["01/02/21 23:59:58", "02/02/21 00:00:00"], 2 / 86400),
        (["21-04-07 23:59:58", "21-04-08 00:00:00"], 2 / 86400),
        (
            ["5/1/2020 10:00:00", "6/1/2020 10:00:00", "1/2/2020 10:00:00"],
            27.0,
        ),  # forward as day and month only
        (["2020-05-13 10:00:00", "2020-05-14 10:00:00"], 1.0),
        (["22:41:07:512", "22:41:10:500"], 2.988 / 86400),
        (["4/12/2021 22:41:07:512", "4/12/2021 22:41:10:500"], 2.988 / 86400),
        (["23:59:59", "00:00:02"], 3 / 86400),
        (["2024-03-31T01:59:58+01:00", "2024-03-31T03:00:00+02:00"], 2 / 86400),
        (["2024-10-27 00:59:59-0300", "2024-10-27 00:00:01-04"], 2 / 86400),
        (["2024-03-31 23:30:00Z", "2024-04-01 05:00:03 +05:30"], 3 / 86400),
    ],
)
def test_a_column_has_one_order(tmp_path, cells, days):
    assert seconds(tmp_path, cells)[-1] == pytest.approx(days * 86400, abs=1e-5)


def test_rows_that_no_order_allows_are_an_error(tmp_path):
    with pytest.raises(DataError, match=r"line 2, column 'stamp': '13/14/2021 10:00' is not a time"):
        seconds(tmp_path, ["4/12/2021 09:00", "13/14/2021 10:00"])


def test_a_missing_stamp_is_missing(tmp_path):
    found = seconds(tmp_path, ["4/30/2021 09:00", "", "5/1/2021 09:00"])
    np.testing.assert_allclose(found, [0, np.nan, 86400])

"""Linear algebra of the library stays in one thread, and the caller's setting comes back."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from miburi.threads import one_thread


def threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_one_thread_inside_and_what_was_before_afterwards() -> None:
    np.linalg.eigh(np.eye(3))  # loads the library
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        assert one_thread(threads)() == {1}
        assert threads() == before
    assert before != {1}, "BLAS takes no second thread here: this test shows nothing"

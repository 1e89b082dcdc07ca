"""Labels in, motion out: hidden Markov models of labelled motion ([H])."""

from miburi.hmm.generation import log_likelihood, mlpg
from miburi.hmm.left_out import LeftOut, leave_one_out
from miburi.hmm.model import Covariance, Form, Model
from miburi.hmm.sequences import global_variance
from miburi.hmm.splicing import Spliced, largest_step, splice, steps
from miburi.hmm.streaming import DelayError, delay_errors, stream, stream_labels
from miburi.hmm.synthesis import Synthesis, check_string, hand_motion, lengths, synthesize, total_length
from miburi.hmm.timing import durations
from miburi.hmm.training import train, train_labels
from miburi.hmm.windows import by_label, deltas, windows

__all__ = [
    "Covariance",
    "DelayError",
    "Form",
    "LeftOut",
    "Model",
    "Spliced",
    "Synthesis",
    "by_label",
    "check_string",
    "delay_errors",
    "deltas",
    "durations",
    "global_variance",
    "hand_motion",
    "largest_step",
    "leave_one_out",
    "lengths",
    "log_likelihood",
    "mlpg",
    "splice",
    "steps",
    "stream",
    "stream_labels",
    "synthesize",
    "total_length",
    "train",
    "train_labels",
    "windows",
]

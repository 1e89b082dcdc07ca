"""Labels in, motion out: hidden Markov models of labelled motion ([H])."""

from miburi.hmm.generation import mlpg
from miburi.hmm.model import Covariance, Form, Model
from miburi.hmm.sequences import global_variance
from miburi.hmm.splicing import Spliced, largest_step, splice, steps
from miburi.hmm.synthesis import Synthesis, check_string, hand_motion, lengths, synthesize, total_length
from miburi.hmm.timing import durations
from miburi.hmm.training import train
from miburi.hmm.windows import by_label, deltas, windows

__all__ = [
    "Covariance",
    "Form",
    "Model",
    "Spliced",
    "Synthesis",
    "by_label",
    "check_string",
    "deltas",
    "durations",
    "global_variance",
    "hand_motion",
    "largest_step",
    "lengths",
    "mlpg",
    "splice",
    "steps",
    "synthesize",
    "total_length",
    "train",
    "windows",
]

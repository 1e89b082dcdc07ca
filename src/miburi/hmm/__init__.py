"""Labels in, motion out: hidden Markov models of labelled motion ([H])."""

from miburi.hmm.generation import log_likelihood, mlpg
from miburi.hmm.model import Covariance, Form, Model
from miburi.hmm.sequences import global_variance
from miburi.hmm.splicing import Spliced, largest_step, splice, steps
from miburi.hmm.strings import Succession, Word, draw, label_of, parse, successions, untrainable
from miburi.hmm.synthesis import Synthesis, check_string, hand_motion, lengths, synthesize, total_length
from miburi.hmm.timing import durations
from miburi.hmm.training import train
from miburi.hmm.windows import by_label, deltas, windows

__all__ = [
    "Covariance",
    "Form",
    "Model",
    "Spliced",
    "Succession",
    "Synthesis",
    "Word",
    "by_label",
    "check_string",
    "deltas",
    "draw",
    "durations",
    "global_variance",
    "hand_motion",
    "label_of",
    "largest_step",
    "lengths",
    "log_likelihood",
    "mlpg",
    "parse",
    "splice",
    "steps",
    "successions",
    "synthesize",
    "total_length",
    "train",
    "untrainable",
    "windows",
]

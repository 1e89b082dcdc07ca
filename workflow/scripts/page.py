"""Everything that a run has made → one page."""

from pathlib import Path

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import Synthesis, by_label, splice
from miburi.report.assemble import corpus_of, of_corpus
from miburi.report.whole import report


def main(snakemake):
    given, p = snakemake.input, snakemake.params
    spliced = {}
    for path in given.syntheses:
        motion = of_corpus(given.motion, corpus_of(path))
        takes, _ = labelled_takes(motion, of_corpus(given.annotations, corpus_of(path))[0])
        spliced[Path(path).stem] = splice(by_label(takes, None), Synthesis.open(path).string)
    files = {kind: [paths] if isinstance(paths, str) else list(paths) for kind, paths in given.items()}
    store.write_text(snakemake.output[0], report(files, p.config, p.corpora, p.joints, spliced))


job.run(main, snakemake)  # noqa: F821

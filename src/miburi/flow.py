"""What the workflow knows before any job: the checked config, takes, shards, and which files there will be."""

from __future__ import annotations

import atexit
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

from miburi import corpora, job, takes
from miburi.config import Config, Corpus, check
from miburi.errors import InputError
from miburi.strings import label_of
from miburi.takes import Take

_READ = (
    "skeleton",
    "stand_ins",
    "fps",
    "rates",
    "unit",
    "up",
    "joints",
    "calibration",
    "columns",
    "skip_frames",
    "drop_rest_pose",
)
_ANNOTATED = ("folder", "keyword", "keywords", "annotations", "labels", "label_unit", "stand_ins", "joints")


def _with_recordings(value: Any, folder: str) -> Any:
    return value.replace("{recordings}", folder) if isinstance(value, str) else value


@dataclass(frozen=True)
class Flow:
    """Takes, shards and files of a config; made by `plan`."""

    config: Config

    def names(self, kind: str) -> list[str]:
        """Names of the corpora of hands or bodies."""
        return [name for name, corpus in self.config.corpora.items() if corpus.kind == kind]

    def corpus(self, name: str) -> Corpus:
        """Settings of a corpus."""
        return self.config.corpora[name]

    @cached_property
    def takes(self) -> dict[str, list[Take]]:
        """Takes of each corpus."""
        return {name: corpora.takes(name, self.config) for name in self.config.corpora}

    @cached_property
    def shards(self) -> dict[str, dict[str, list[Take]]]:
        """Takes of each shard of each corpus."""
        return {name: corpora.shards(found, self.config.shard_seconds) for name, found in self.takes.items()}

    @cached_property
    def _groups(self) -> dict[str, list[dict[str, Any]]]:
        folder = self.config.recordings
        return {
            name: [
                {key: _with_recordings(value, folder) for key, value in group.model_dump().items()}
                for group in corpora.groups(name, corpus, self.config.seed)
            ]
            for name, corpus in self.config.corpora.items()
        }

    def performed(self, by: str) -> list[str]:
        """Names of the corpora that a simulation performs."""
        return [name for name, corpus in self.config.corpora.items() if corpus.perform == by]

    def performance(self, corpus: str) -> list[str]:
        """Files of a simulated corpus."""
        folder = f"data/raw/{corpus}"
        found = [t.recording for t in self.takes[corpus]] + [f"{folder}/annotations.tsv"]
        if self.corpus(corpus).perform == "janken":
            found += [f"{folder}/wearer.yaml", *self.annotation_files(corpus)]
        return found

    def performers(self, corpus: str) -> list[str]:
        """Who performs in a simulated corpus of bodies."""
        return sorted({t.subject for t in self.takes[corpus]})

    def performed_by(self, corpus: str, performer: str) -> dict[str, str]:
        """Takes of a performer and their files."""
        return {t.name: t.recording for t in self.takes[corpus] if t.subject == performer}

    def fetched(self) -> list[tuple[str, str]]:
        """Corpus and subject of everything that is fetched."""
        return [(name, subject) for name, corpus in self.config.corpora.items() for subject in corpus.fetch]

    def downloads(self, corpus: str, subject: str) -> list[str]:
        """Files of a fetched subject."""
        mine = [t.recording for t in self.takes[corpus] if t.subject == subject]
        return [f"data/raw/{corpus}/{subject}.asf", *mine]

    def simulated(self, corpus: str) -> bool:
        """Whether a corpus is of simulated people."""
        settings = self.corpus(corpus)
        return bool(settings.perform) or settings.simulated

    def of_shards(self, corpus: str, stage: str) -> list[str]:
        """Artefacts of a stage for all shards of a corpus."""
        return [f"results/{corpus}/{stage}/{shard}.h5" for shard in self.shards[corpus]]

    def shard_of(self, corpus: str, take: str) -> str:
        """The shard that holds a take.

        Raises
        ------
        InputError
            The corpus has no such take.
        """
        for shard, found in self.shards[corpus].items():
            if any(t.name == take for t in found):
                return shard
        raise InputError(f"there is no take {take!r} in corpus {corpus!r}")

    def files(self, corpus: str, shard: str) -> list[str]:
        """Files that a shard is read from."""
        groups = self._groups[corpus]
        found: dict[str, None] = {}
        for take in self.shards[corpus][shard]:
            group = groups[take.group]
            found[take.recording] = None
            for key in takes.COMPANIONS:
                if group[key]:
                    found[takes.filled(group[key], take, group)] = None
        return list(found)

    def to_read(self, corpus: str, shard: str) -> dict[str, Any]:
        """What reading a shard needs: takes and the settings of their groups."""
        found = self.shards[corpus][shard]
        return {
            "takes": [[t.name, t.subject, t.recording, t.group] for t in found],
            "groups": {t.group: self._settings(corpus, t.group, _READ) for t in found},
        }

    def to_annotate(self, corpus: str) -> dict[str, Any]:
        """What annotating a corpus needs: takes and the settings of their groups."""
        found = self.takes[corpus]
        return {
            "takes": [[t.name, t.subject, t.recording, t.group] for t in found],
            "groups": {t.group: self._settings(corpus, t.group, _ANNOTATED) for t in found},
            "kind": self.corpus(corpus).kind,
        }

    def _settings(self, corpus: str, group: int, keys: Sequence[str]) -> dict[str, Any]:
        return {key: self._groups[corpus][group][key] for key in keys}

    def annotation_files(self, corpus: str) -> list[str]:
        """Files that say what happens in a corpus: labels of hands, annotations of bodies."""
        groups = self._groups[corpus]
        if self.corpus(corpus).kind == "hand":
            return [takes.label_file(t, groups[t.group]) for t in self.takes[corpus]]
        return sorted({g[key] for g in groups for key in ("annotations", "keywords") if g[key]})

    def bounded(self, corpus: str) -> dict[str, dict[str, str]]:
        """Takes that segmentation is scored on: how each was cut, and its file of cut points, if any."""
        groups = self._groups[corpus]
        found = {}
        for take in self.takes[corpus]:
            group = groups[take.group]
            file = takes.filled(group["cut_points"], take, group)
            points = file if file and Path(file).exists() else ""
            named = any(fnmatchcase(take.name, pattern) for pattern in group["bounds"])
            if group["cut"] != "whole" and (points or named):
                found[take.name] = {"method": group["cut"], "cut_points": points}
        return found

    def cut_points(self, corpus: str) -> list[str]:
        """Files of cut points of a corpus."""
        return [b["cut_points"] for b in self.bounded(corpus).values() if b["cut_points"]]

    def agreements(self) -> list[str]:
        """How cuts agree with people's, for each corpus that has any."""
        return [f"results/{c}/segmentation.csv" for c in self.names("body") if self.bounded(c)]

    def segmentations(self) -> list[str]:
        """`agreements`, and how long all segments are."""
        return self.agreements() + [f"results/{c}/segment_lengths.csv" for c in self.names("body")]

    def per_take(self, corpus: str, shard: str, key: str) -> dict[str, Any]:
        """A group's setting for each take of a shard where it is not empty."""
        groups = self._groups[corpus]
        found = {t.name: groups[t.group][key] for t in self.shards[corpus][shard]}
        return {take: value for take, value in found.items() if value}

    def labels(self, string: str) -> list[str]:
        """Different labels of a string that is not drawn at random, in the order of their first use."""
        return list(dict.fromkeys(label_of(word) for word in self.config.strings[string].labels.split()))

    def is_random(self, string: str) -> bool:
        """Whether a string is drawn from the recordings."""
        return self.config.strings[string].random is not None

    def models(self, corpus: str, string: str) -> list[str]:
        """Models of the labels of a string that is not drawn at random."""
        return [f"results/{corpus}/models/{label}.h5" for label in self.labels(string)]

    def training(self, string: str) -> dict[str, Any] | None:
        """How models are trained, for a string that is drawn at random."""
        return self.config.train.model_dump() if self.is_random(string) else None

    def string(self, string: str) -> dict[str, Any]:
        """Speed, length and what else generation needs to know of a string."""
        return self.config.strings[string].model_dump(exclude={"corpus", "labels", "random", "pairs"})

    def words(self, string: str) -> dict[str, Any]:
        """What a string's words are made of, and what its labels need to be trained."""
        settings = self.config.strings[string].model_dump(include={"labels", "random", "pairs"})
        needs = self.config.train.model_dump(include={"states", "exit", "least_intervals"})
        return {**settings, **needs, "seed": self.config.seed}

    def to_play(self, experiment: str) -> dict[str, Any]:
        """What playing the queries of an experiment needs."""
        settings = self.config.experiments[experiment]
        played = settings.model_dump(exclude={"corpus", "measures"})
        return {**played, "imagined": self.corpus(settings.corpus).perform == "everyday"}

    def experiment_folder(self, experiment: str) -> str:
        """results/{corpus} of an experiment's corpus."""
        return f"results/{self.config.experiments[experiment].corpus}"

    def ranks(self, experiment: str) -> list[str]:
        """Ranks of all measures of an experiment."""
        folder = self.experiment_folder(experiment)
        return [f"{folder}/ranks/{experiment}/{m}.h5" for m in self.config.experiments[experiment].measures]

    def gplvm(self, corpus: str, measure: str) -> list[str]:
        """GP-LVMs of a corpus, where a measure needs them."""
        return [f"results/{corpus}/gplvm.h5"] if "GP-LVM" in measure else []

    def scores(self) -> list[str]:
        """Scores of all experiments."""
        return [self.scores_of(e) for e in self.config.experiments]

    def lengths(self) -> list[str]:
        """Lengths and largest jumps of all strings."""
        return [f"results/{s.corpus}/synthesis/{name}.csv" for name, s in self.config.strings.items()]

    def filled_tables(self) -> dict[str, str]:
        """Tables of [P] and ours beside them that this config's experiments fill, and the experiment of each."""
        first, second = self.config.tables.experiment1, self.config.tables.experiment2
        which = {"table1": first, "table2": first, "table3": second, "table4": first, "table5": second}
        which |= {"differences1": first, "differences2": second}
        if first and 3 in self.config.experiments[first].protocols:
            which["other_people"] = first
        return {table: experiment for table, experiment in which.items() if experiment}

    def tables(self) -> list[str]:
        """Tables that this config fills."""
        found = [f"results/{name}.csv" for name in self.filled_tables()]
        return found + (["results/label_counts.csv"] if self.config.tables.string else [])

    def scores_of(self, experiment: str) -> str:
        """Scores of an experiment."""
        return f"{self.experiment_folder(experiment)}/scores/{experiment}.csv"

    def shown_corpus(self) -> str:
        """Corpus of the string that [H]'s figures show."""
        return self.config.strings[self.config.tables.string or ""].corpus

    def of_string(self, path: str) -> str:
        """A file of that corpus; `{string}` is filled in."""
        return f"results/{self.shown_corpus()}/{path}".replace("{string}", self.config.tables.string or "")

    def changes(self, string: str) -> list[str]:
        """The changes of [H], fig. 6, that a string holds."""
        return [c for c in self.config.tables.changes if c in self.labels(string)]

    def of_corpora(self, path: str) -> list[str]:
        """A file of every corpus."""
        return [f"results/{name}/{path}" for name in self.config.corpora]

    def indices(self) -> list[str]:
        """Indices of all corpora that are searched."""
        used = [e.corpus for e in self.config.experiments.values()] + list(self.config.search)
        return [f"results/{name}/index.h5" for name in dict.fromkeys(used)]

    def described(self) -> dict[str, dict[str, Any]]:
        """What the report says of each corpus."""
        return {
            name: {"kind": corpus.kind, "simulated": self.simulated(name)}
            for name, corpus in self.config.corpora.items()
        }

    def figures(self) -> list[str]:
        """Figures of [H] that this config's string can fill."""
        if not self.config.tables.string:
            return []
        strips = ["results/fig6.png"] if self.changes(self.config.tables.string) else []
        return ["results/fig4.png", "results/fig5.png", *strips, "results/staircase.png"]

    def shown(self) -> dict[str, list[str]]:
        """Artefacts of all corpora, strings and experiments that the report shows, by kind."""
        strings, experiments = self.config.strings.items(), self.config.experiments.items()
        return {
            "motion": [p for c in self.config.corpora for p in self.of_shards(c, "motion")],
            "segments": [p for c in self.names("body") for p in self.of_shards(c, "segments")],
            "syntheses": [f"results/{s.corpus}/synthesis/{name}.h5" for name, s in strings],
            "models": list(
                dict.fromkeys(
                    f"results/{s.corpus}/models/{m}.h5" for name, s in strings for m in self.labels(name)
                )
            ),
            "queries": [f"data/raw/{e.corpus}/queries/{name}/queries.tsv" for name, e in experiments],
            "query_logs": [f"data/raw/{e.corpus}/queries/{name}/logs" for name, e in experiments],
            "query_features": [f"results/{e.corpus}/queries/{name}.h5" for name, e in experiments],
            "ranks": [p for name in self.config.experiments for p in self.ranks(name)],
        }

    def named_joints(self) -> dict[str, dict[str, Any]]:
        """Corpus → take → names of joints, where a config gives them."""
        return {
            c: {t: j for s in self.shards[c] for t, j in self.per_take(c, s, "joints").items()}
            for c in self.names("body")
        }

    def film_names(self) -> list[tuple[str, str]]:
        """Corpus and name of each film that `all` makes."""
        found = [(s.corpus, name) for name, s in self.config.strings.items()]
        return found + [(f.corpus, name) for name, f in self.config.films.items()]

    def films(self) -> list[str]:
        """Films and their contact sheets."""
        return [
            f"results/{corpus}/film/{name}{ending}"
            for corpus, name in self.film_names()
            for ending in (".mp4", "_sheet.png")
        ] + [f"results/{s.corpus}/compared/{name}.mp4" for name, s in self.config.strings.items()]

    def own_logs(self, corpus: str) -> dict[str, str]:
        """Puppet logs in the folder that the config names for a corpus: name → path."""
        search = self.config.search.get(corpus)
        return _puppet_logs(_with_recordings(search.folder, self.config.recordings)) if search else {}

    def logs(self, corpus: str) -> dict[str, str]:
        """Puppet logs that are ranked in a corpus: name → path. data/puppet serves every corpus."""
        found = self.own_logs(corpus)
        return found | {name: path for name, path in _puppet_logs("data/puppet").items() if name not in found}

    def searches(self) -> list[str]:
        """Rankings of the logs in the folders that the config names, and their pages."""
        found = [f"results/{c}/search/{q}" for c in self.config.search for q in self.logs(c)]
        return [f"{path}{ending}" for path in found for ending in (".csv", ".html")]

    def targets(self, corpus: str) -> str:
        """Table of what a corpus' logs imitate."""
        return str(_with_recordings(self.config.search[corpus].targets, self.config.recordings))

    def to_compare(self, corpus: str) -> dict[str, Any]:
        """What comparing our users with a corpus' logs needs: those of its first experiment."""
        search = self.config.search[corpus]
        name, experiment = next((n, e) for n, e in self.config.experiments.items() if e.corpus == corpus)
        return {
            "experiment": name,
            "users": experiment.users,
            "measures": experiment.measures,
            "target": search.target,
            "queries": list(self.own_logs(corpus)),
            "simulated": search.simulated,
        }

    def comparisons(self) -> list[str]:
        """Comparisons of our users with logs of another origin, where there are such logs."""
        played = {e.corpus for e in self.config.experiments.values()}
        return [
            f"results/{c}/puppeteers.csv"
            for c, search in self.config.search.items()
            if search.targets and c in played and Path(self.targets(c)).exists()
        ]

    def simulated_log(self, corpus: str, query: str) -> bool:
        """Whether the config says that a log is a simulator's."""
        search = self.config.search.get(corpus)
        return bool(search and search.simulated) and not self.log_of(corpus, query).startswith("data/puppet")

    def log_of(self, corpus: str, query: str) -> str:
        """Path of a puppet log."""
        return self.logs(corpus).get(query, f"data/puppet/{query}.csv")

    def motion_of(self, corpus: str, name: str) -> str:
        """The motion artefact that holds what a film shows."""
        take = self.stretch(corpus, name)[0]
        return f"results/{corpus}/motion/{self.shard_of(corpus, take)}.h5"

    def stretch(self, corpus: str, name: str) -> tuple[str, float, float | None]:
        """Take, first and last second of a body's film: one of the config's, or a whole take by its name."""
        film = self.config.films.get(name)
        if film is not None and film.corpus == corpus:
            return film.take, film.start_s, film.end_s
        return name, 0.0, None


def _puppet_logs(folder: str) -> dict[str, str]:
    """Name → path of the puppet logs in a folder."""
    found: dict[str, str] = {}
    for path in sorted([*Path(folder).glob("*.csv"), *Path(folder).glob("*.csv.gz")]):
        found.setdefault(path.name.removesuffix(".gz").removesuffix(".csv"), str(path))
    return found


def one_of(names: Iterable[str]) -> str:
    """A wildcard's pattern: one of these names, or nothing at all."""
    return "|".join(re.escape(name) for name in names) or "(?!)"


def none_of(names: Iterable[str]) -> str:
    """A pattern of a film's name: any but these."""
    return rf"(?!({one_of(names)})(\.mp4|_sheet\.png)$)[^/]+"


def plan(config: Mapping[str, Any]) -> Flow:
    """Check the config and find the takes, or end the program with one sentence."""
    try:
        flow = Flow(check(config))
        _ = flow.shards
        for name in flow.config.films:
            film = flow.config.films[name]
            flow.shard_of(film.corpus, film.take)
    except InputError as error:
        # one sentence; an exception here would be shown with the Snakefile's lines around it
        print(error, file=sys.stderr)
        raise SystemExit(1) from None
    return flow


def say_last(since: float) -> None:
    """Repeat the sentences of failed jobs when the program ends, so that they are the last on the terminal.

    Parameters
    ----------
    since
        When the run began (`time.time`): only jobs that failed later count.
    """
    logs = [path for path in Path("results/logs").rglob("*.log") if path.stat().st_mtime >= since]
    said = list(dict.fromkeys(found for path in sorted(logs) if (found := job.sentence(path))))
    if said:
        atexit.register(lambda: print("\n" + "\n".join(said), file=sys.stderr, flush=True))

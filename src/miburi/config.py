"""The config's one model: every key with its type, default and meaning.

The JSON schema beside the workflow, the table of keys in config/README.md and the checks before any job starts all
come from here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from miburi.errors import InputError

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")]


class Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Group(Model):
    """Recordings of one kind in one folder."""

    folder: str = Field(
        description="Folder of the recordings; `{recordings}` stands for the key of that name."
    )
    files: list[str] = Field(description="Patterns of the recordings below the folder.")
    exclude: list[str] = Field([], description="Patterns of recordings that are left out.")
    take: str = Field(
        "",
        description="Regular expression whose group `take` is the take's name in the path below the folder; empty: the path without endings, `/` written as `-`.",
    )
    subject: str = Field(
        "",
        description="Regular expression whose group `subject` tells who performs; empty: the corpus has one subject.",
    )
    skeleton: str = Field(
        "",
        description="ASF of the AMC recordings; `{subject}` and `{recordings}` are filled in. Empty: found beside the recording.",
    )
    stand_ins: dict[str, str] = Field({}, description="Subject → subject whose skeleton is used instead.")
    keyword: str = Field(
        "", description="Regular expression whose group `keyword` is the keyword of the whole take."
    )
    annotations: str = Field(
        "", description="TSV with take, start_s, end_s, keyword; `{recordings}` is filled in."
    )
    keywords: str = Field(
        "", description="TSV with take and keyword, of whole takes; `{recordings}` is filled in."
    )
    cut: Literal["PPCA", "PCA", "whole"] = Field(
        "PPCA", description="How takes become segments: by segmentation, or each take is one."
    )
    bounds: list[str] = Field(
        [],
        description="Patterns of takes whose annotations cover them whole: segmentation is scored on where these change.",
    )
    cut_points: str = Field(
        "",
        description="File of a take's cut points set by a person (earliest, best, latest acceptable frame), before `bounds`; `{take}` and `{recordings}` are filled in.",
    )
    fps: float | None = Field(
        None, gt=0, description="Frames per second, where recordings name none or a wrong rate."
    )
    rates: dict[str, float] = Field(
        {}, description="Take → frames per second, where single headers are wrong."
    )
    skip_frames: int = Field(0, ge=0, description="Frames left out at the start in any case.")
    drop_rest_pose: bool = Field(
        True,
        description="Leave out rest poses that a program put before the motion, told by the impossible speed at which they are left.",
    )
    unit: float | None = Field(
        None, gt=0, description="Metres per unit of the recordings; absent: found by the size of the body."
    )
    up: Literal["x", "y", "z"] | None = Field(
        None, description="The recordings' upward axis; absent: found by the rest pose."
    )
    joints: dict[str, str] = Field(
        {}, description="Joint of the 42 values → name in these recordings, where the tables do not know it."
    )
    calibration: str = Field(
        "", description="Glove: calibration of the wearer; empty: the only .yaml beside the log."
    )
    columns: str = Field(
        "", description="Glove: column map of a foreign logger, such as config/gloves/cyberglove_rps.yaml."
    )
    labels: str = Field(
        "",
        description="Hand: label file of a take; `{take}` and `{recordings}` are filled in. Empty: `{take}.lab` beside the log.",
    )
    label_unit: Literal["100ns", "frames", "seconds"] | None = Field(
        None, description="Unit of the times in HTK label files; absent: by their size."
    )

    @field_validator("take", "subject", "keyword")
    @classmethod
    def _expression(cls, text: str, info: Any) -> str:
        if text:
            try:
                groups = re.compile(text).groupindex
            except re.error as error:
                raise ValueError(f"{text!r} is no regular expression: {error}") from None
            if info.field_name not in groups:
                raise ValueError(f"{text!r} has no group (?P<{info.field_name}>…)")
        return text


class Corpus(Model):
    """A named set of recordings."""

    kind: Literal["hand", "body"] = Field(description="What was recorded.")
    perform: Literal["janken", "everyday", ""] = Field(
        "",
        description="The simulation that performs the recordings into data/raw/{corpus}; empty: they are there.",
    )
    small: bool = Field(False, description="A simulated corpus of a minute, for trying and testing.")
    fetch: list[str] = Field(
        [], description="Subjects of the CMU database that are fetched into data/raw/{corpus}."
    )
    site: str = Field("http://mocap.cs.cmu.edu", description="Where the CMU database lies.")
    groups: list[Group] = Field([], description="The recordings; a simulated or fetched corpus needs none.")
    once: bool = Field(
        False, description="A take that several files hold is read from the first; otherwise it is an error."
    )
    simulated: bool = Field(
        False, description="The recordings are of simulated people; simulated corpora say so by themselves."
    )

    @model_validator(mode="after")
    def _has_recordings(self) -> Corpus:
        if sum([bool(self.perform), bool(self.fetch), bool(self.groups)]) != 1:
            raise ValueError("needs exactly one of perform, fetch and groups")
        return self


class Segmentation(Model):
    """PPCA segmentation (Barbič et al. 2004)."""

    variance: float = Field(0.9, gt=0, lt=1, description="Share of the variance that the subspace keeps (τ).")
    window_s: float = Field(1.5, gt=0, description="Length of the first window, seconds.")
    ahead_s: float = Field(1.25, gt=0, description="Length of the look-ahead, seconds.")
    step_s: float = Field(1 / 6, gt=0, description="Step of the window, seconds.")
    rise: float = Field(4.0, gt=1, description="A peak that is so many times its valley makes a cut (R).")
    near_s: float = Field(
        2 / 3,
        ge=0,
        description="Cuts found forwards and backwards that are nearer than this are one, seconds.",
    )
    differ: float = Field(
        4.5,
        ge=0,
        description="A cut is kept where one model explains its two sides worse than two do by this much (twice the log-likelihood ratio for each frame).",
    )
    shortest_s: float = Field(0.5, ge=0, description="Shorter pieces are joined to a neighbour, seconds.")


class Features(Model):
    """The 42 values of a frame ([P])."""

    angle_weight: float = Field(0.3, gt=0, description="Metres that one radian of the trunk's angles counts.")
    mapped: bool = Field(True, description="Map all people onto one skeleton, as [P] does.")


class Index(Model):
    """The index of segments."""

    dims: int = Field(5, ge=1, le=42, description="Dimensions of each segment's subspace.")
    samples: int | None = Field(50, ge=1, description="Frames drawn from each side (K); null: all.")
    reduction: Literal["max", "mean"] = Field("max", description="How SM reduces over the query's frames.")


class Gplvm(Model):
    """GP-LVMs of segments and queries, for the measures SM(GP-LVM) and DSPM(GP-LVM)."""

    dims: int = Field(2, ge=1, le=10, description="Latent dimensions.")
    frames: int = Field(
        25,
        ge=2,
        description="So many of the drawn frames of each side are trained on and projected, evenly spaced.",
    )
    iterations: int = Field(100, ge=1, description="Iterations of training (L-BFGS) at most.")
    starts: int = Field(2, ge=1, description="Starts from which a new frame's latent point is sought.")


class Train(Model):
    """The labels' HMMs ([H])."""

    states: int = Field(3, ge=1, description="States of each label.")
    covariance: Literal["diagonal", "full"] = Field("diagonal", description="Form of the covariance.")
    exit: bool = Field(
        True, description="The last state has an exit arc, as in HTK; false: as printed in [H]."
    )
    iterations: int = Field(20, ge=1, description="Iterations of EM at most.")
    tolerance: float = Field(1e-4, ge=0, description="EM stops when the log-likelihood per frame gains less.")
    floor: float = Field(0.01, ge=0, description="Variance floor, as a share of the variance of all frames.")
    half: tuple[int, int] = Field((1, 1), description="Half lengths L1, L2 of the delta windows.")
    durations: Literal["exact", "product"] = Field(
        "exact", description="Durations from the model, or by eqs. 9-11 as printed."
    )
    least_intervals: int = Field(
        1, ge=1, description="A label with fewer intervals that are long enough is refused."
    )


class String(Model):
    """A string of labels to synthesise."""

    corpus: Name = Field(description="Corpus whose models are used.")
    labels: str = Field(
        "",
        description="Labels, separated by blanks; `r*2` lasts twice as long as r usually does, `r=1.5s` a second and a half.",
    )
    random: int | None = Field(
        None, ge=1, description="Instead of labels: so many of them, drawn from the recordings' successions."
    )
    pairs: Literal["recorded", "any"] = Field(
        "recorded", description="A label may follow another only where the recordings show it, or any may."
    )
    rho: float = Field(0.0, description="Speed: states last m + ρσ² frames.")
    length: int | None = Field(None, ge=1, description="Frames in all, instead of rho.")
    alpha: float | None = Field(
        None,
        gt=0,
        description="Weight of the durations against the trajectory, eq. 18 of [H]; null: infinite, eq. 20.",
    )
    global_variance: bool = Field(
        False, description="The motion varies as much as the recordings do (Toda and Tokuda)."
    )

    @model_validator(mode="after")
    def _labels_or_random(self) -> String:
        if bool(self.labels.strip()) == (self.random is not None):
            raise ValueError("needs exactly one of labels and random")
        return self


class Film(Model):
    """A film of a body take and its contact sheet."""

    corpus: Name = Field(description="Corpus of the take.")
    take: str = Field(description="Name of the take.")
    start_s: float = Field(0.0, ge=0, description="First second shown.")
    end_s: float | None = Field(None, gt=0, description="Last second shown; null: the end.")


class Search(Model):
    """Puppet logs that are ranked in a corpus."""

    folder: str = Field(description="Folder of the logs; `{recordings}` is filled in.")
    simulated: bool = Field(
        False, description="The logs are a simulator's; those whose first line says so need not be told."
    )
    targets: str = Field(
        "",
        description="TSV whose column `query` names logs of the folder that imitate takes of the corpus; development users imitate them too (results/{corpus}/puppeteers.csv). `{recordings}` is filled in.",
    )
    target: str = Field(
        "{take}", description="The take that a log imitates, made of that table's columns in braces."
    )


class Experiment(Model):
    """A retrieval experiment of [P] with simulated users."""

    corpus: Name = Field(description="Corpus that is ranked.")
    keywords: list[str] = Field(min_length=1, description="What the users look for.")
    protocols: list[Literal[1, 2, 3]] = Field(
        [1, 2],
        description="1: the shown clip is imitated; 2: the keyword is imagined; 3: as 1, only other subjects are ranked.",
    )
    users: int = Field(5, ge=1, description="Simulated users.")
    split: Literal["test", "development"] = Field(
        "test", description="Which users; settings are chosen with development users only."
    )
    measures: list[str] = Field(min_length=1, description="Measures that are compared.")


class Tables(Model):
    """Which experiments and strings the papers' tables and figures show."""

    experiment1: Name | None = Field(None, description="Experiment of tables 1, 2 and 4.")
    experiment2: Name | None = Field(None, description="Experiment of tables 3 and 5.")
    string: Name | None = Field(
        None, description="String of figures 4, 5 and 6 and of the lengths in label_counts.csv."
    )
    angle: str = Field(
        "middle3_x", description="Angle of figures 4 and 5 and of the staircase: joint and axis (z, x or y)."
    )
    changes: list[str] = Field(
        ["rs", "sp", "pr"], description="Labels that figure 6 shows strips of, where the string has them."
    )


class Render(Model):
    """Films and contact sheets."""

    width: int = Field(640, ge=64, description="Pixels.")
    height: int = Field(480, ge=64, description="Pixels.")
    fps: float = Field(30.0, gt=0, description="Pictures per second.")
    columns: int = Field(8, ge=1, description="Pictures in a row of a contact sheet.")


class Config(Model):
    """Everything that a run of the workflow depends on."""

    seed: int = Field(2011, description="All randomness derives from it.")
    recordings: str = Field(
        "../shared/data", description="Folder of real recordings, `{recordings}` in groups."
    )
    on_error: Literal["stop", "skip"] = Field(
        "stop", description="A damaged recording stops its corpus, or is set aside and listed in skipped.csv."
    )
    shard_seconds: float = Field(
        600.0, gt=0, description="About how many seconds of motion one job processes."
    )
    corpora: dict[Name, Corpus] = Field(min_length=1, description="The sets of recordings.")
    segment: Segmentation = Field(default_factory=Segmentation, description="Segmentation.")
    features: Features = Field(default_factory=Features, description="Features of bodies.")
    index: Index = Field(default_factory=Index, description="Index.")
    gplvm: Gplvm = Field(default_factory=Gplvm, description="Latent variable models.")
    train: Train = Field(default_factory=Train, description="Training.")
    strings: dict[Name, String] = Field({}, description="Strings of labels to synthesise.")
    films: dict[Name, Film] = Field({}, description="Films of body takes that `all` makes.")
    render: Render = Field(default_factory=Render, description="Rendering.")
    experiments: dict[Name, Experiment] = Field({}, description="Retrieval experiments.")
    tables: Tables = Field(default_factory=Tables, description="What the papers' tables show.")
    search: dict[Name, Search] = Field({}, description="Corpus → logs ranked in results/{corpus}/search/.")
    search_measure: str = Field(
        "DSPM(PCA)+Jvh", description="Measure of results/{corpus}/search/{query}.csv."
    )
    baseline: str = Field(
        "", description="Committed metrics that `snakemake check` compares with; empty: none."
    )

    @model_validator(mode="after")
    def _refers_to_what_is_there(self) -> Config:
        def known(name: str, names: Mapping[str, Any], where: str, what: str) -> None:
            if name not in names:
                raise ValueError(
                    f"{where}: there is no {what} {name!r}; there are {', '.join(sorted(names)) or 'none'}"
                )

        for n, s in self.strings.items():
            known(s.corpus, self.corpora, f"strings.{n}.corpus", "corpus")
            if self.corpora[s.corpus].kind != "hand":
                raise ValueError(f"strings.{n}.corpus: {s.corpus!r} is not a corpus of hands")
        for n, f in self.films.items():
            known(f.corpus, self.corpora, f"films.{n}.corpus", "corpus")
        for n, e in self.experiments.items():
            known(e.corpus, self.corpora, f"experiments.{n}.corpus", "corpus")
        for n in self.search:
            known(n, self.corpora, f"search.{n}", "corpus")
        for key in ("experiment1", "experiment2"):
            if (e := getattr(self.tables, key)) is not None:
                known(e, self.experiments, f"tables.{key}", "experiment")
        if self.tables.string is not None:
            known(self.tables.string, self.strings, "tables.string", "string")
            if not self.strings[self.tables.string].labels:
                raise ValueError("tables.string: a string drawn at random cannot be shown, name its labels")
        return self


def check(config: Mapping[str, Any]) -> Config:
    """The config as a model, defaults filled in.

    Raises
    ------
    InputError
        One sentence that names the first wrong key, what was found and what was expected.
    """
    try:
        return Config.model_validate(dict(config))
    except ValidationError as error:
        # a misspelt key is unknown, and may be missing under its right name: the former says more
        first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
        key = ".".join(str(p) for p in first["loc"])
        if first["type"] == "extra_forbidden":
            near = _nearest(first["loc"], Config)
            hint = f"; did you mean {near!r}?" if near else ""
            raise InputError(f"config: there is no key {key!r}{hint}") from None
        if first["type"] == "missing":
            raise InputError(f"config: the key {key!r} is missing") from None
        message = first["msg"].removeprefix("Value error, ")
        found = first.get("input")
        shown = (
            f" (found {found!r})"
            if isinstance(found, (str, int, float, bool)) and repr(found) not in message
            else ""
        )
        raise InputError(f"config: {key + ': ' if key else ''}{message}{shown}") from None


def _nearest(path: tuple[int | str, ...], model: type[BaseModel]) -> str | None:
    """The key that a misspelt one probably means: the closest among its siblings."""
    import difflib

    for part in path[:-1]:
        if isinstance(part, str) and part in model.model_fields:
            inner = _model_in(model.model_fields[part].annotation)
            if inner is not None:
                model = inner
    close = difflib.get_close_matches(str(path[-1]), list(model.model_fields), 1)
    return close[0] if close else None


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """The model inside `list[Group]`, `dict[str, Corpus]` or the like."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in getattr(annotation, "__args__", ()):
        if (found := _model_in(inner)) is not None:
            return found
    return None


def schema() -> dict[str, Any]:
    """JSON schema of the config (draft 2020-12)."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Config.model_json_schema()}


def all_keys(model: type[BaseModel] = Config, prefix: str = "") -> list[tuple[str, str, str]]:
    """Every key as (dotted name, default as YAML, description); `*` stands for a name of the user's."""
    import yaml

    rows: list[tuple[str, str, str]] = []
    for name, info in model.model_fields.items():
        inner = _model_in(info.annotation)
        text = str(info.annotation)
        dotted = prefix + name
        if info.is_required():
            default = "required"
        elif inner is not None and info.default_factory is not None:
            default = ""
        else:
            value = info.get_default(call_default_factory=True)
            value = list(value) if isinstance(value, tuple) else value
            default = yaml.safe_dump(value, default_flow_style=True).replace("\n...\n", "").strip()
        rows.append((dotted, default, info.description or ""))
        if inner is not None:
            star = ".*" if "dict[" in text else "[]" if "list[" in text else ""
            rows += all_keys(inner, f"{dotted}{star}.")
    return rows

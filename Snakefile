# Motion recordings in; tables, figures and animation out. What can be asked for stands in `all` and in README.md.

from snakemake.utils import min_version

min_version("9.0")


# a config given by --configfile stands by itself
if not workflow.config_settings.configfiles:

    configfile: "config/config.yaml"


report: "workflow/report/workflow.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/perform.smk"
include: "workflow/rules/ingest.smk"
include: "workflow/rules/segment.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/index.smk"
include: "workflow/rules/train.smk"
include: "workflow/rules/synthesize.smk"
include: "workflow/rules/render.smk"
include: "workflow/rules/query.smk"
include: "workflow/rules/score.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/hand_figures.smk"
include: "workflow/rules/metrics.smk"
include: "workflow/rules/report.smk"


localrules:
    all,


rule all:
    default_target: True
    input:
        FLOW.tables(),
        FLOW.figures(),
        FLOW.films(),
        FLOW.searches(),
        FLOW.comparisons(),
        FLOW.segmentations(),
        "results/metrics.json",
        "results/report.html",

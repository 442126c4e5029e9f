"""The site: what Sphinx reads. ``make docs`` builds it; nothing is fetched while it is built or read."""

from __future__ import annotations

import importlib
import sys
import warnings
from pathlib import Path
from shutil import copyfile

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests"), str(HERE.parent / "src")]

import matplotlib  # noqa: E402

matplotlib.use("Agg")

from generate import changelog, pages, player  # noqa: E402

import trunnion as tn  # noqa: E402

project = "Trunnion"
author = "The Trunnion developers"
copyright = author
version = release = tn.__version__

extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx_gallery.gen_gallery"]
myst_enable_extensions = ["attrs_block", "colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "gallery", "generated/gallery/*.ipynb"]
smartquotes = False  # who copies --speed "1500 rpm" gets what a shell understands
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]  # types of other libraries; intersphinx would fetch their lists
html_theme = "furo"
html_title = "Trunnion"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_search_summary = False  # excerpts are fetched, which a browser refuses to pages from disk
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}
suppress_warnings = ["config.cache"]
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"

MATHJAX = Path(importlib.import_module("sphinx-mathjax-offline").__file__).parent / "static/mathjax/tex-svg.js"
mathjax_path = "tex-svg.js"

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "generated/gallery",
    "filename_pattern": r"[/\\]plot_",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "min_reported_time": 5,
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
    "remove_config_comments": True,
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("generate.gallery_pictures.pictures",),
    "capture_repr": (),
    "reset_modules": (),
    "plot_gallery": "True",
    "copyfile_regex": r".*\.toml",
}


def _beside_the_pages(app, failure):  # type: ignore[no-untyped-def]
    """One file of MathJax with its letters inside, and the line that turns on the home page."""
    if failure is None:
        copyfile(MATHJAX, Path(app.outdir) / "_static" / MATHJAX.name)
        player.write_page(Path(app.outdir) / "_static" / player.FILE)


def _links_out_of_docs(app, name, source):  # type: ignore[no-untyped-def]
    """Files at the top of the project are pages of the site too; a page that the home page does not list is a guide."""
    if not name.startswith("generated/"):
        folder = (HERE / name).parent
        up = "../" * len(folder.relative_to(HERE).parts)
        source[0] = changelog.leaving(source[0], folder, up)
    if name == "index":
        listed = source[0].split()
        new = [page.stem for page in sorted(HERE.glob("*.md")) if page.stem not in (*listed, "index")]
        source[0] = source[0].replace("\nreport\napp\n", "\n".join(["", "report", "app", *new, ""]))
        source[0] = player.embedded(source[0])


def setup(app):  # type: ignore[no-untyped-def]
    """Pages that come from the package are written first."""
    warnings.simplefilter("ignore", tn.InputRemark)
    pages.write(HERE / "generated")
    app.connect("source-read", _links_out_of_docs)
    app.connect("build-finished", _beside_the_pages)

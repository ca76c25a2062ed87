"""The cell in three dimensions, with Meshcat: live in a browser, or as a standalone HTML replay.

It draws what a recording's scene stream holds, so that a live view and a replay show the same.
The caller turns everything into world coordinates: this package knows no camera.
"""

from robots.viewer.frame import CameraCone, SceneFrame, ShownBox
from robots.viewer.html import write_html
from robots.viewer.live import LiveViewer
from robots.viewer.stage import Eye, Stage

__all__ = ["CameraCone", "Eye", "LiveViewer", "SceneFrame", "ShownBox", "Stage", "write_html"]

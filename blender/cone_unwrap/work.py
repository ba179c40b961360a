"""The work on several meshes beside Blender: on a thread of its own, told how far it is, stopped when that is asked for.

Blender's data may be used by its main thread alone. So meshes are read before the work begins and written when it is done; between these
nothing here knows Blender.
"""

import threading

import cones

#: How far the work on a mesh is when a stage begins, as it was on scans of 100 thousand vertices.
BEGINS = {"prepare": 0.0, "factor": 0.1, "hierarchy": 0.3, "curvature": 0.5, "cut": 0.55, "scale": 0.6, "layout": 0.8, "islands": 0.85, "pack": 0.9}


class Stopped(Exception):
    """The work was told to stop."""


class Work:
    """Unwraps meshes one after the other: pairs of a name and the keywords of :func:`cones.unwrap`, the mesh among them.

    ``tell`` hears how far the work is, in the thread that does it.
    """

    def __init__(self, jobs, tell=lambda fraction: None):
        self.jobs, self._hears = jobs, tell
        #: For each job a result, or an error that is told.
        self.outcomes = []
        #: What is done now, in words, and how far all of it is, between 0 and 1.
        self.stage, self.fraction = "", 0.0
        self._stops = threading.Event()
        self._failure = None
        self._thread = None

    def start(self):
        """Begins on a thread of its own."""
        self._thread = threading.Thread(target=self._guarded, daemon=True)
        self._thread.start()

    def stop(self):
        """Tells the work to stop, and waits for that: some tenths of a second on large meshes."""
        self._stops.set()
        if self._thread:
            self._thread.join()

    def is_done(self):
        """Whether all jobs have an outcome; raises what was no error of a mesh."""
        if self._thread and self._thread.is_alive():
            return False
        if self._failure:
            raise self._failure
        return True

    def run(self):
        """Does the work in the thread that calls."""
        for k, (name, keywords) in enumerate(self.jobs):
            try:
                self.outcomes.append(cones.unwrap(**keywords, progress=lambda stage, fraction: self._tell(k, name, stage, fraction)))  # noqa: B023
            except cones.Error as error:
                self.outcomes.append(error)

    def _guarded(self):
        try:
            self.run()
        except BaseException as error:  # noqa: BLE001 - handed to the thread that asks
            self._failure = error

    def _tell(self, k, name, stage, fraction):
        if self._stops.is_set():
            raise Stopped
        reached = BEGINS.get(stage, 0.0) + 0.1 * (fraction or 0.0)
        self.fraction = max(self.fraction, (k + reached) / len(self.jobs))
        self.stage = f"{name}: {stage}"
        self._hears(self.fraction)

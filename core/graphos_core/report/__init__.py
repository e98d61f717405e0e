"""The report as data: what was computed, how well, and what to know about it; the keys are documented here.

``report.json`` holds exactly this dictionary; what was not computed is null, or 0 where it is a count. Residuals are
computed − given (projected − measured). A *spread* is ``count, mean, rms, median, q05, q95, least, largest`` of the
finite values; *per axis* is a list for X, Y, Z.

=====================  ================================================================================================
key                    meaning
=====================  ================================================================================================
``schema``             1
``project``            name of the project
``data_hash``          hash of the photos that were used, 16 hexadecimal digits
``made``               date and time of the run, UTC (added when the files are written)
``results``            key of the stored result of every step that exists, by step
``problems[]``         problems first: ``severity`` (error, warning, info), ``what, why, todo, learn`` (lesson), ``items[]``
                       (names of photos, points, parameters concerned)
``images``             ``total``; ``oriented``; ``names`` (in order); ``not_oriented[]`` (``name``, ``reason``);
                       ``unusable[]`` (files that could not be read, ``name``, ``reason``)
``cameras[]``          ``label, model, model_label, direction, width, height`` (px); ``pixel_pitch_mm``; ``focal_px``;
                       ``focal_estimated`` (true while the principal distance is a guess that no adjustment improved);
                       ``focal_source``; ``pre_corrections[]`` (fixed, applied first); ``parameters[]`` with ``name, symbol,
                       label, unit, value, sigma`` (null where it was not estimated), ``reason`` (why it usually is not) and, where tested, ``t, limit, significant, correlation,
                       correlated_with`` (largest correlation with another unknown of the camera); ``correlations``:
                       ``names, symbols, matrix`` of the estimated parameters; ``profile``: radial distortion,
                       ``radius_px``, ``gaussian`` and ``balanced`` each with ``focal_px, shift_px, sigma_px`` per radius (σ
                       null without covariance), ``note``; ``projection_uncertainty``: ``columns_px, rows_px, sigma_px`` (rows of columns), ``note``
``matching``           ``keypoints`` per photo; ``pairs_tried, pairs_verified``; ``tracks``; ``components`` (photos per
                       group of the image graph, largest first)
``orientation``        ``points``; ``observations`` (image points, two coordinates each); ``scalar_observations`` (all
                       groups); ``reprojection_rms_px``: per coordinate, over all observations of the final model, px of
                       the full photo; ``sigma0``: a posteriori standard deviation of unit weight, without unit;
                       ``sigma0_px``: the same in px, for an image coordinate whose a priori standard deviation is
                       ``prior_px``; ``redundancy``; ``unknowns``; ``mean_rays_per_point``; ``unit`` (``m`` or ``model
                       units``); ``datum``; ``converged``; ``stop_reason``; ``iterations``; ``iteration_records[]`` with
                       ``iteration, cost, step, damping, gradient, accepted``; ``global_test`` (``statistic, lower, upper,
                       alpha, passed``); ``groups[]`` with ``kind, unit, count, redundancy, squares, sigma0, rms, factor``;
                       ``extras[]`` (``name, value, sigma, unit``); ``definitions`` by key; ``photos[]`` with ``name``,
                       ``camera`` (index), ``centre``, ``sigma_centre`` (in ``unit``), ``omega_phi_kappa_deg``,
                       ``sigma_omega_phi_kappa_deg``, ``sigma_rotation_deg`` (about the camera's axes), ``observations``,
                       ``coverage`` (share of grid cells with a point), ``rms_px``, ``mean_residual_px``
``object_points``      ``count``; ``unit``; ``rays`` (number of points by number of rays); ``intersection_angle_deg``
                       (spread of the widest angle of each point); ``sigma``: spread for ``x, y, z``; ``undetermined``
``residuals``          ``count`` (coordinates); ``mean_px, std_px`` per coordinate; ``nmad_px``; ``largest_px``;
                       ``longest_px`` (of a vector); ``down_weighted`` (observations the robust function took weight
                       from); ``kurtosis_excess``; ``normal_correlation`` (Filliben 1975; 1 for normal noise)
``reliability``        ``alpha, power, critical, delta0``; ``redundancy_numbers, mdb_px, effect`` (spreads; effect in
                       ``unit``); ``weakly_controlled`` (redundancy number below 0.1); ``tested, beyond_critical,
                       expected_beyond``; ``suspects[]`` with ``photo, point, coordinate, position_px, residual_px, w, tau,
                       redundancy_number, mdb_px, effect``, the largest |w| first
``georeferencing``     ``method``; ``scale`` (m per model unit); ``origin_m`` (add it to coordinates); ``rms_m`` and
                       ``check_rms_m`` per coordinate (null where there are none); ``points[]`` with ``name, check,
                       residual_m``
``control``            ``how`` (``weighted observations``, ``held fixed``, ``similarity``); ``count``; ``rms_m`` per axis; ``points[]`` with
                       ``name, residual_m, sigma_m`` (a priori), ``w``, per axis
``check``              check points, apart from control: ``count``; ``mean_m, rms_m`` per axis; ``predicted_m`` (root mean
                       square per axis of ``√(σ² + σ_given²)``); ``points[]`` with ``name, role`` (``check``, or ``placed`` where it
                       placed the block by the similarity), ``residual_m, sigma_m`` (computed
                       coordinates), ``given_sigma_m``, ``normalised``
``known[]``            every other group: ``kind, unit, count, listed``, ``observations[]`` with ``label, observed, residual,
                       sigma, redundancy_number, w, mdb``
``statement``          precision against accuracy: ``verdict`` (``confirmed, optimistic, cautious, not checked``),
                       ``precision, accuracy, text``, ``factor`` (root mean square of the normalised check residuals)
``left_out[]``         parts that are missing: ``part``, ``reason``
``dense``              ``points``; ``depth_maps``; ``unit``
``products[]``         files beside the report: ``file``, ``what``
``quality``            internal ``figures``; ``advice[]``; ``comparison`` (``statistics``, ``unit``, ``definition``) or null
``timings_s``          seconds of computing per stage (of an earlier run where the result was taken from the store)
``peak_memory_mb``     largest resident memory of this process; null where the system does not tell
``seed``, ``version``  of the recipe; of the program
``warnings[]``         sentences
=====================  ================================================================================================
"""

from graphos_core.report.build import SCHEMA, build_report, data_hash, peak_memory_mb
from graphos_core.report.values import plain, rms

__all__ = ["SCHEMA", "build_report", "data_hash", "peak_memory_mb", "plain", "rms"]

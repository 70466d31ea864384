# SPDX-License-Identifier: GPL-3.0-or-later
"""Random configurations of scanners and patterns."""
import numpy as np

from oracle.drawing import DURATION_S, Drawing


class Mechanisms(Drawing):
    def scanner(self, dealt):
        b = self.between
        kind, *more = dealt["scanner"].split()
        if kind == "flash":
            return {"type": "flash"}
        if kind == "polygon":
            facets = self.whole(20, 40)
            tilts = {"facet_tilt_rad": b(-0.003, 0.003, facets)} if self.chance(0.4) else {}
            if self.chance(0.4):
                tilts.update(facet_tilt_sigma_rad=b(0, 1e-3), facet_tilt_known=self.chance(0.5))
            return {"type": kind, "facets": facets, "rate_hz": b(2, 4), "phase_deg": b(0, 360),
                    "line_azimuth_deg": b(-180, 180), "duty_frac": b(0.2, 0.4), "frame_amplitude_deg": b(1, 3),
                    "frame_rate_hz": b(2, 10), **tilts, **self.encoders()}
        if kind == "palmer":
            return {"type": kind, "tilt_deg": b(0.5, 1.8), "incidence_deg": b(0, 50), "fold_azimuth_deg": b(-180, 180),
                    "rate_hz": b(20, 100), "phase_deg": b(-180, 180)}
        if kind == "table":
            t = np.concatenate([[0], np.cumsum(self.rng.uniform(0.01, 0.04, 8))]) - 0.01
            t[-1] = max(t[-1], DURATION_S + 0.01)
            size = 0.05 if more[0] == "gimbal" else 0.025
            path = self.table("angles.csv", {"t_s": t, "angle_1_rad": b(-size, size, 9), "angle_2_rad": b(-size, size, 9)})
            mirror = {"incidence_deg": b(0, 45), "fold_azimuth_deg": b(-90, 90)} if more[0] == "fsm" else {}
            return {"type": kind, "path": path, "mechanism": more[0], **mirror}
        if kind == "risley":
            return self.risley(more[0], dealt)
        config = {"type": kind, "pattern": self.pattern(dealt["pattern"]), **self.encoders()}
        if self.chance(0.3):
            config["max_acceleration_radps2"] = b(20, 2000)
        if self.chance(0.4):
            config.update(turnaround_time_s=b(0.0005, 0.003), settle_time_s=b(0.001, 0.01), settle_damping=b(0.3, 0.9))
        if kind == "fsm":
            config.update(incidence_deg=self.one_of([0, b(0, 60)]), fold_azimuth_deg=b(-180, 180))
            if self.chance(0.4):
                config.update(pivot_m=b(-0.02, 0.02, 3), focal_distance_m=b(0, 0.3))
            config.update(tof_lag=self.chance(0.3), encoder_sigma_rad=b(0, 1e-3) if self.chance(0.4) else 0)
        return config

    def encoders(self):
        if not self.chance(0.4):
            return {}
        return {"encoder_harmonics": [{"axis": self.whole(1, 2), "order": self.whole(1, 200), "amplitude_rad": self.between(0, 1e-3),
                                       "phase_deg": self.between(-180, 180)} for _ in range(self.whole(1, 3))]}

    def risley(self, kind, dealt):
        b = self.between
        noise = {"encoder_sigma_rad": b(0, 1e-3) if self.chance(0.5) else 0}
        if kind == "reflecting":
            rate = b(5, 9)
            return {"type": "risley", "wedge_deg": 41.5, "rates_hz": [rate, rate], **noise}
        prisms = {"type": "risley", "configuration": self.one_of(["PTTP", "TPPT", "PTPT", "TPTP"]), "gap_m": b(0.001, 0.02)}
        if kind == "rates":
            return {**prisms, "index": b(1.4, 1.8, 2), "wedge_deg": b(1.5, 3, 2), "thickness_m": b(0.003, 0.01, 2),
                    "rates_hz": b(-100, 100, 2), "phases_deg": b(-180, 180, 2), **noise}
        return {**prisms, "configuration": self.one_of(["PTTP", "TPPT"]), "index": b(1.45, 1.6), "wedge_deg": b(8, 9),
                "branch": self.one_of(["positive", "negative"]), "pattern": self.pattern(dealt["pattern"]), **noise}

    def pattern(self, kind):
        b, half = self.between, self.between(1.5, 2.2)
        common = {"compensated": self.chance(0.7)}
        direction = self.one_of(["unidirectional", "boustrophedon"])
        if kind in ("line_search", "ramped"):
            return {"type": "line_search", "rows": self.whole(1, 11), "columns": self.whole(2, 11), "half_width_m": half,
                    "direction": direction, "ramped": kind == "ramped", "at_end": self.one_of(["wrap", "wrap", "stop"]),
                    **common}
        if kind == "step_stare":
            return {"type": kind, "rows": self.whole(2, 6), "columns": self.whole(2, 6), "half_width_m": half,
                    "pulses_per_step": self.whole(1, 5), "direction": direction, "at_end": self.one_of(["wrap", "stop"]),
                    **common}
        if kind == "spiral":
            return {"type": kind, "radius_m": half, "pitch_m": b(0.3, 0.8), "inner_radius_m": b(0, 0.5),
                    "direction": self.one_of(["outward", "inward"]), **common,
                    **({"period_s": b(0.03, 0.2)} if self.chance(0.5) else {})}
        if kind == "rosette":
            return {"type": kind, "radius_m": half, "rates_hz": b(-100, 100, 2), "phases_deg": b(-180, 180, 2), **common}
        if kind == "lissajous":
            return {"type": kind, "half_width_m": self.one_of([half, b(1.5, 2.2, 2)]), "rates_hz": b(5, 90, 2),
                    "phase_deg": b(-180, 180), **common}
        if kind == "stare":
            return {"type": kind, "aim_m": b(-1.5, 1.5, 2), **common}
        end = self.one_of(["stop", "hold", "wrap"])
        t = np.concatenate([[0], np.cumsum(self.rng.uniform(0.005, 0.02, 7))])
        x, y = b(-2, 2, 8), b(-2, 2, 8)
        if end == "wrap":
            x[-1], y[-1] = x[0], y[0]
        return {"type": kind, "path": self.table("aims.csv", {"t_s": t, "x_m": x, "y_m": y}), "at_end": end, **common}

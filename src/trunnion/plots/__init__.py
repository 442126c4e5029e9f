"""Pictures of results. matplotlib is loaded when the first one is drawn; no global state is touched."""

DRAWINGS = {
    # linear
    "NaturalFrequencies.plot": "trunnion.plots.mode_shapes:draw",
    "CampbellDiagram.plot": "trunnion.plots.campbell_diagram:draw",
    "OrderResponse.plot": "trunnion.plots.order_response:draw",
    "SpeedSweep.plot": "trunnion.plots.torque_over_speed:draw",
    "StabilityChart.plot": "trunnion.plots.stability_chart:draw",
    "StableLimit.plot": "trunnion.plots.stable_limit:draw",
    "StableWindows.plot": "trunnion.plots.tongues:draw_windows",
    "Envelope.plot": "trunnion.plots.envelope:draw",
    "Comparison.plot": "trunnion.plots.comparison:draw",
    "Optimum.plot": "trunnion.plots.optimum:draw",
    "Sensitivities.plot": "trunnion.plots.sensitivity:draw",
    "StabilityCertificate.plot": "trunnion.plots.certificate:draw",
    "ToleranceStudy.plot": "trunnion.plots.tolerance:draw",
    "Tongues.plot": "trunnion.plots.tongues:draw",
    "Kinetostatics.plot": "trunnion.plots.kinetostatics:draw",
    # motions
    "SystemSimulation.plot": "trunnion.plots.motion:draw_history",
    "SystemSimulation.plot_portrait": "trunnion.plots.motion:draw_portrait",
    "LineSimulation.plot": "trunnion.plots.motion:draw_line_history",
    "LineSimulation.plot_order_map": "trunnion.plots.order_map:draw",
    "RunUp.plot": "trunnion.plots.run_up:draw",
    "PeriodicOrbit.plot": "trunnion.plots.motion:draw_orbit",
    "LinearityCheck.plot": "trunnion.plots.linearity:draw",
    "PeriodicResponse.plot": "trunnion.plots.motion:draw_period",
    "PeriodicResponse.plot_orders": "trunnion.plots.motion:draw_orders",
    "PeriodicBranch.plot": "trunnion.plots.response_curve:draw",
    # gaps
    "ResponseCurves.plot": "trunnion.plots.frequency_response:draw_response",
    "OscillatorSweep.plot": "trunnion.plots.frequency_response:draw_sweep",
    "LineSweep.plot": "trunnion.plots.frequency_response:draw_line_sweep",
    "Basins.plot": "trunnion.plots.frequency_response:draw_basins",
    # chaos
    "LyapunovSpectrum.plot": "trunnion.plots.chaos:draw_convergence",
    "LyapunovSweep.plot": "trunnion.plots.chaos:draw_sweep",
    "LyapunovMap.plot": "trunnion.plots.chaos:draw_lyapunov_map",
    "PoincareMap.plot": "trunnion.plots.chaos:draw_map",
    "BifurcationDiagram.plot": "trunnion.plots.chaos:draw_bifurcations",
    "ChaosCertificate.plot": "trunnion.plots.chaos:draw_certificate",
}
"""What draws a result: ``Class.method`` → ``module:function``."""

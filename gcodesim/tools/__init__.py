"""Tools: one file a kind, its parameters on top; `TOOLS[kind]` is the dataclass.

All form cutters give an outline (`form_cutter`), from which edges, body and the part that cuts follow.
"""

from gcodesim.family import Family

TOOLS = Family(
    "tools",
    of="gcodesim.tools.tool:Tool",
    called="kind",
    flat_end_mill="gcodesim.tools.flat_end_mill:FlatEndMill",
    ball_end_mill="gcodesim.tools.ball_end_mill:BallEndMill",
    bull_nose_end_mill="gcodesim.tools.bull_nose_end_mill:BullNoseEndMill",
    face_mill="gcodesim.tools.face_mill:FaceMill",
    chamfer_mill="gcodesim.tools.chamfer_mill:ChamferMill",
    v_bit="gcodesim.tools.v_bit:VBit",
    engraver="gcodesim.tools.engraver:Engraver",
    taper_ball_end_mill="gcodesim.tools.taper_ball_end_mill:TaperBallEndMill",
    lollipop_mill="gcodesim.tools.lollipop_mill:LollipopMill",
    dovetail_mill="gcodesim.tools.dovetail_mill:DovetailMill",
    t_slot_mill="gcodesim.tools.t_slot_mill:TSlotMill",
    key_cutter="gcodesim.tools.key_cutter:KeyCutter",
    corner_rounding_mill="gcodesim.tools.corner_rounding_mill:CornerRoundingMill",
    thread_mill="gcodesim.tools.thread_mill:ThreadMill",
    profile_mill="gcodesim.tools.profile_mill:ProfileMill",
    saw="gcodesim.tools.saw:Saw",
    drill="gcodesim.tools.drill:Drill",
    spot_drill="gcodesim.tools.spot_drill:SpotDrill",
    step_drill="gcodesim.tools.step_drill:StepDrill",
    countersink="gcodesim.tools.countersink:Countersink",
    reamer="gcodesim.tools.reamer:Reamer",
    tap="gcodesim.tools.tap:ThreadTap",
    boring_bar="gcodesim.tools.boring_bar:BoringBar",
    drag_knife="gcodesim.tools.drag_knife:DragKnife",
    extruder="gcodesim.tools.extruder:Extruder",
    welding_torch="gcodesim.tools.welding_torch:WeldingTorch",
    laser="gcodesim.tools.laser:Laser",
    plasma="gcodesim.tools.plasma:Plasma",
    jet="gcodesim.tools.jet:Jet",
    sand_blaster="gcodesim.tools.sand_blaster:SandBlaster",
    spray_gun="gcodesim.tools.spray_gun:SprayGun",
    finger_gripper="gcodesim.tools.finger_gripper:FingerGripper",
    suction_gripper="gcodesim.tools.suction_gripper:SuctionGripper",
    end_effector="gcodesim.tools.end_effector:EndEffector",
    probe="gcodesim.tools.probe:Probe",
    camera="gcodesim.tools.sensor_heads:CameraHead",
    depth_camera="gcodesim.tools.sensor_heads:DepthCameraHead",
    line_scanner="gcodesim.tools.sensor_heads:LineScannerHead",
    turning_tool="gcodesim.tools.turning_tool:TurningTool",
    boring_tool="gcodesim.tools.turning_tool:BoringTool",
    grooving_tool="gcodesim.tools.grooving_tool:GroovingTool",
    parting_tool="gcodesim.tools.grooving_tool:PartingTool",
    threading_tool="gcodesim.tools.threading_tool:ThreadingTool",
)

__all__ = ["TOOLS"]

"""Facts read off narratives: one short report a row, then rules that hold for any text."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.inference.untold_moves import BESIDE, OVER_MIDDLE
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.privacy import redact

Statement = dict[str, tuple[str | None, str | None]]
REPORTS: tuple[tuple[str, Statement, dict[str, str] | None], ...] = (
    (
        "Vehicle #1, a 1999 Honda Civic, was southbound in the right lane. Vehicle #2, a 2001 Ford Focus, was "
        "stopped facing south ahead of it at a red light. The front of Vehicle #1 struck the back of Vehicle "
        "#2.",
        {"V1": ("S", "straight"), "V2": ("S", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 was northbound in lane one. V2 was stopped in lane one directly ahead of V1 waiting to turn left. "
        "V1 rear-ended V2.",
        {"V1": ("N", "straight"), "V2": ("N", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "Both vehicles were traveling east; V2 was ahead of V1. V2 slowed for traffic and was rear-ended by "
        "V1.",
        {"V1": ("E", "straight"), "V2": ("E", "slowing")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1, a 1998 Saturn SL, and V2, a 2003 Kia Rio, were traveling west on the roadway, with V1 coming up "
        "behind V2. V2 began to turn left into a driveway and V1, attempting to pass, struck V2's left side "
        "with its front.",
        {"V1": ("W", "overtaking"), "V2": ("W", "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was exiting a parking lot, attempting to make a left onto the northbound roadway. V2 was "
        "traveling southbound in the right lane. The front of V2 struck the left side of V1.",
        {"V2": ("S", "straight"), "V1": ("E", "turn_left")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 made a left turn from a private driveway onto a westbound two-lane two-way roadway. V2 was "
        "traveling east on the roadway. V1 was struck on the left side by the front of V2.",
        {"V1": (None, "turn_left"), "V2": ("E", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "The Dodge was parked facing north on the right shoulder. Vehicle 1, a 2002 Dodge Neon, was legally "
        "parked on the right shoulder and unoccupied. Vehicle 2 was traveling north when it drifted off the "
        "road and its right front struck the left rear of Vehicle 1.",
        {"V1": ("N", "parked"), "V2": ("N", None)}, {"V2": "front", "V1": "back"},
    ),
    (
        "V1 had been eastbound on the intersecting roadway and was attempting a left turn at the "
        "T-intersection. V2 was northbound. V2's front impacted V1's driver side.",
        {"V1": ("E", "turn_left"), "V2": ("N", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 was traveling in the middle lane and attempted to change lanes to the right. Both were heading "
        "south on a six-lane freeway. The right side of V1 contacted the left side of V2.",
        {"V1": ("S", "lane_change_right")}, {"V1": "right", "V2": "left"},
    ),
    (
        "V1 was traveling around a jug-handle intending to turn left at the intersection with the east/west "
        "roadway. V2 was westbound and going straight. The front of V1 struck the left side of V2.",
        {"V2": ("W", "straight"), "V1": ("N", "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was traveling north. V2 was traveling south in the opposite lane. As V1 was going straight, V2 "
        "turned left across its path and the front of V1 hit V2 on the right side.",
        {"V1": ("N", "straight"), "V2": ("S", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was heading westbound and V2 was eastbound on a curved road. V1 crossed over the centerline into "
        "the eastbound lane and collided head-on with V2.",
        {"V1": ("W", "crossing_centerline"), "V2": ("E", "straight")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 was eastbound. V1 ran off the right side of the road, the driver overcorrected to the left and "
        "re-entered in a counterclockwise yaw, crossing into the westbound lane. V2 was traveling west. V1's "
        "right side was struck by the front of V2.",
        {"V1": ("E", "crossing_centerline"), "V2": ("W", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 was northbound in lane two. V2 was northbound in lane one. V1 did not see V2 in the next lane and "
        "moved into it. V1 and V2 sideswiped, V1's right side against V2's left side.",
        {"V1": ("N", None), "V2": ("N", "straight")}, {"V1": "right", "V2": "left"},
    ),
    (
        "V1 was traveling south and V2 was traveling east. V1 and V2 entered the intersection at the same "
        "time. The passenger side of V1 made contact with the front of V2.",
        {"V1": ("S", "straight"), "V2": ("E", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 collided with the back of V2, pushing V2 into V3. All vehicles were traveling north. V3 was "
        "stopped in traffic.",
        {"V1": ("N", "straight"), "V3": ("N", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "A 2001 Toyota Camry (V1) was traveling south on Main Street. A 1999 Chevrolet Tahoe (V2) was "
        "traveling west on First Avenue. The Camry failed to stop at the stop sign and was hit by the Tahoe "
        "in the driver's door.",
        {"V1": ("S", "straight"), "V2": ("W", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 was stopped facing east at the stop sign waiting to turn right. V2 was southbound. V1 pulled out "
        "and the front of V2 struck the left front of V1.",
        {"V1": ("E", "turn_right"), "V2": ("S", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "Vehicle one (V1 - case vehicle), a 2000 Ford Taurus, 4-door sedan was traveling west in the left "
        "westbound lane of a four-lane road. Vehicle two (V2), a 1997 Dodge Ram, pickup truck was traveling "
        "east in the eastbound left-turn lane of the same road. V2 attempted to turn left at the intersection "
        "and the front of V1 struck the right side of V2 in an L-type configuration.",
        {"V1": ("W", "straight"), "V2": ("E", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was backing out of a driveway onto the roadway. V2 was eastbound. The back of V1 struck the right "
        "side of V2.",
        {"V1": (None, "backing"), "V2": ("E", "straight")}, {"V1": "back", "V2": "right"},
    ),
    (
        "V1 was traveling northbound, made a U-turn and was struck on the left side by V2, which was also "
        "northbound.",
        {"V1": ("N", "u_turn"), "V2": ("N", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V2 was eastbound in the center lane. V1 was merging onto the interstate from the entrance ramp. The "
        "left side of V1 contacted the right side of V2.",
        {"V2": ("E", "straight"), "V1": (None, "merge")}, {"V1": "left", "V2": "right"},
    ),
    (
        "Vehicle #1 was traveling in a northerly direction. Vehicle #2 approached from the left and ran the "
        "stop sign. The front of V1 struck V2 in the right side.",
        {"V1": ("N", "straight"), "V2": ("E", "straight")}, {"V1": "front", "V2": "right"},
    ),
    (
        "Vehicle #1 was westbound. Vehicle #2 entered the roadway from a driveway on the right into the path "
        "of Vehicle #1, intending to turn left. Vehicle #1 struck Vehicle #2 in its left side.",
        {"V1": ("W", "straight"), "V2": ("S", "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "The driver of V1, a 34-year-old male, was driving eastbound in lane 2 of a 4-lane road. The driver "
        "of V2, a 45-year old female, was westbound and intended to turn left into a shopping center. V2 "
        "began the turn and was struck by V1.",
        {"V1": ("E", "straight"), "V2": ("W", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was traveling west when an unknown vehicle cut in front of it. V1 swerved left, crossed the "
        "double yellow line and struck the front of V2, which was eastbound, with its front.",
        {"V1": ("W", "crossing_centerline"), "V2": ("E", "straight")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 was southbound in lane three. V2 was southbound in lane two. V1 changed lanes to the right and "
        "its right rear contacted the left front of V2.",
        {"V1": ("S", "lane_change_right"), "V2": ("S", "straight")}, None,
    ),
    (
        "V1 was traveling north on a two-lane road and V2 was traveling north behind it. V1 stopped to make a "
        "left turn into a driveway. V2 was unable to stop and its front struck the rear of V1.",
        {"V1": ("N", "stopped"), "V2": ("N", "straight")}, {"V2": "front", "V1": "back"},
    ),
    (
        "V1 was eastbound, approaching a signalized intersection. V2 was stopped northbound at the same "
        "intersection. When the light turned green V2 proceeded and the front of V1 struck the left side of "
        "V2.",
        {"V1": ("E", "straight"), "V2": ("N", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "Vehicle 1 was traveling south. Vehicle 1 lost control on the icy road, rotated counterclockwise and "
        "slid sideways into the northbound lane where its passenger side was struck by the front of "
        "northbound Vehicle 2.",
        {"V1": ("S", None), "V2": ("N", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "Unit 1 was travelling east on Elm Street. Unit 2 was travelling north on Oak. Unit 2 failed to yield "
        "and Unit 1 T-boned Unit 2.",
        {"V1": ("E", "straight"), "V2": ("N", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "A 2005 Honda Accord was traveling west on Pine Street when a 2002 Ford F-150 pickup pulled out of a "
        "driveway and turned left. The Accord struck the left side of the pickup.",
        {"V1": ("W", "straight"), "V2": (None, "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1, traveling eastbound, and V2, traveling westbound, collided in the intersection when V2 turned "
        "left.",
        {"V1": ("E", "straight"), "V2": ("W", "turn_left")}, None,
    ),
    (
        "V1 was traveling in the southbound lane and departed the right side of the road and struck a tree "
        "with its front.",
        {"V1": ("S", "departing_road_right")}, None,
    ),
    (
        "V1 was northbound when a pedestrian ran across the road from the right. V1 struck the pedestrian "
        "with its front.",
        {"V1": ("N", "straight")}, None,
    ),
    (
        "Vehicle #1 was northbound in the right lane. Vehicle #2, traveling in the same direction in the left "
        "lane, turned right across the path of Vehicle #1. The front of Vehicle #1 impacted the right side of "
        "Vehicle #2.",
        {"V1": ("N", "straight"), "V2": ("N", "turn_right")}, {"V1": "front", "V2": "right"},
    ),
    (
        "Vehicle #1 was going straight westbound through the intersection on a green light when Vehicle #2, "
        "northbound, ran the red light. Vehicle #2's front contacted Vehicle #1's left side.",
        {"V1": ("W", "straight"), "V2": ("N", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "The crash occurred at a four-legged intersection controlled by traffic signals. Vehicle #1 was a "
        "2001 Volvo V70 wagon traveling north in the first lane. Vehicle #2 was a 2003 Mack dump truck "
        "traveling west in the second lane. At the intersection, the front of Vehicle #1 impacted Vehicle "
        "#2's left side.",
        {"V1": ("N", "straight"), "V2": ("W", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "Vehicle one (V1), a 2000 Honda Civic, was traveling eastbound in lane one approaching the "
        "intersection. Vehicle two (V2), a 1996 Ford Explorer was westbound in the left turn lane with the "
        "intention of turning left. V2 turned left into the path of V1. V1's front struck V2's right front "
        "door.",
        {"V1": ("E", "straight"), "V2": ("W", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was stopped at a stop sign on the southbound side street intending to go straight across. V2 was "
        "traveling east on the main road. V1 entered the intersection and was hit in the right side by V2.",
        {"V1": ("S", "straight"), "V2": ("E", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "The driver of V1 was northbound and attempted to turn left into a gas station. A non-contact van had "
        "stopped to let V1 turn. V2 was southbound in the curb lane. The front of V2 contacted the right side "
        "of V1.",
        {"V1": ("N", "turn_left"), "V2": ("S", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 was traveling west in lane two when its driver attempted to make a right turn into a parking lot "
        "from lane two. V2 was westbound in lane one. V2 struck the right side of V1 with its left front.",
        {"V1": ("W", "turn_right"), "V2": ("W", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "Vehicle #1 was traveling north on a two-lane roadway, negotiating a left curve. Vehicle #2 was "
        "traveling south on the same roadway, negotiating the same curve. Vehicle #1 drifted left of center. "
        "The left front of Vehicle #1 impacted the left front of Vehicle #2.",
        {"V1": ("N", "crossing_centerline"), "V2": ("S", "negotiating_curve")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 was eastbound in the left lane. V2 was eastbound in the right lane, slightly ahead of V1. V2 "
        "changed lanes to the left to avoid a stopped bus and the left rear of V2 was struck by the front of "
        "V1.",
        {"V1": ("E", "straight"), "V2": ("E", "lane_change_left")}, None,
    ),
    (
        "V1, V2 and V3 were all traveling south in the right lane. V3 stopped for a light, V2 stopped behind "
        "V3, and V1 failed to stop. V1 struck the rear of V2 and pushed it into the rear of V3.",
        {"V1": ("S", "straight"), "V2": ("S", "stopped"), "V3": ("S", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V2 was facing north, disabled in the right lane with its flashers on. V1 was traveling north and did "
        "not see V2 until too late. V1's front contacted V2's back.",
        {"V1": ("N", "straight"), "V2": ("N", "parked")}, {"V1": "front", "V2": "back"},
    ),
    (
        "Vehicle 1 was traveling southbound on a rural road. Vehicle 2 was traveling northbound. Vehicle 1 "
        "passed another vehicle on a hill and met Vehicle 2 head-on.",
        {"V1": ("S", None), "V2": ("N", "straight")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 left a private driveway located on the east side of the north/south roadway and turned left to go "
        "south. V2 was going north. V2 impacted the left side of V1.",
        {"V1": ("W", "turn_left"), "V2": ("N", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "Vehicle #2 was turning right onto the eastbound roadway from the south leg. Vehicle #1, eastbound, "
        "struck Vehicle #2 in the left side.",
        {"V1": ("E", "straight"), "V2": ("N", "turn_right")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was northbound making a left turn at the intersection while V2 was southbound going straight "
        "through. V2's front end struck V1's right rear quarter panel.",
        {"V1": ("N", "turn_left"), "V2": ("S", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1, a tractor-trailer, was westbound in lane 1. V2 was westbound in lane 2. V1 moved into lane 2 and "
        "its left side struck the right side of V2.",
        {"V1": ("W", None), "V2": ("W", "straight")}, {"V1": "left", "V2": "right"},
    ),
    (
        "V1 was approaching the intersection from the east. V2 was approaching from the south. Both vehicles "
        "entered on a green light. The front of V1 struck the right side of V2.",
        {"V1": ("W", "straight"), "V2": ("N", "straight")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was traveling eastbound when the driver suffered a seizure and the vehicle crossed the median "
        "into the westbound lanes. V2 was westbound and was struck on its left side by V1's front.",
        {"V1": ("E", "crossing_centerline"), "V2": ("W", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "The Chevy (V1) was going north and the Buick (V2) was heading the opposite direction. The Buick made "
        "a left in front of the Chevy. The Chevy's front hit the Buick's right side.",
        {"V1": ("N", "straight"), "V2": ("S", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "Vehicle #1 was driving westbound. Vehicle #2 was stopped in the westbound lane, attempting to turn "
        "left into a driveway. Vehicle #1 hit Vehicle #2 from behind.",
        {"V1": ("W", "straight"), "V2": ("W", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 was traveling eastbound in the number two lane at 45 mph. V2 was stopped in traffic in the number "
        "two lane facing eastbound. The driver of V1 looked down at a phone. V1 impacted V2 in the rear.",
        {"V1": ("E", "straight"), "V2": ("E", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 exited the interstate and was traveling down the off ramp, westbound. V2 was stopped at the end "
        "of the ramp for the traffic light. The front of V1 struck the rear of V2.",
        {"V1": ("W", "straight"), "V2": ("W", "stopped")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 was southbound and V2 was northbound on the same two-lane road. V2 attempted to turn left onto a "
        "side street in front of V1. The fronts of both vehicles collided.",
        {"V1": ("S", "straight"), "V2": ("N", "turn_left")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 was traveling south through the intersection. V2 came from the right and failed to stop. The "
        "front end of V2 struck the passenger side of V1.",
        {"V1": ("S", "straight"), "V2": ("E", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 was westbound. V2 was making a left turn from the northbound lanes to go west. The front of V1 "
        "struck V2's left rear door.",
        {"V1": ("W", "straight"), "V2": ("N", "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was parked along the curb facing south. V1 pulled away from the curb into the path of V2, "
        "southbound. The left side of V1 was contacted by the front of V2.",
        {"V1": ("S", None), "V2": ("S", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 was traveling northbound and V2 was traveling northbound ahead of V1. V2 slowed to turn right "
        "into a driveway. V1 could not stop and the front of V1 struck the back of V2.",
        {"V1": ("N", "straight")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 was eastbound and slid through a stop sign because of snow. V2 was traveling north. The front of "
        "V1 impacted the left side of V2.",
        {"V1": ("E", "straight"), "V2": ("N", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1, a motorcycle, was traveling south at a high rate of speed. V2 was northbound, turning left. V1 "
        "laid down and slid into the right side of V2.",
        {"V1": ("S", None), "V2": ("N", "turn_left")}, None,
    ),
    (
        "The front of V1 (eastbound) struck the left side of V2 (southbound) when V2 failed to stop for the "
        "red light.",
        {"V1": ("E", "straight"), "V2": ("S", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was in the left-turn lane for northbound traffic, and V2 was southbound in the second lane from "
        "the curb. V1 began its left turn and was struck by V2, front to right side.",
        {"V1": ("N", "turn_left"), "V2": ("S", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "Vehicle one (V1 - case vehicle), a 2003 Chevrolet Impala, 4-door sedan was traveling south in the "
        "southbound lane of a two-lane, two-way rural road and was approaching a T-intersection. Vehicle two "
        "(V2), a 1999 Ford F150, 2-door pickup truck was traveling east on the intersecting road and was "
        "approaching the same intersection as V1. The driver of V2 failed to stop at the stop sign, entered "
        "the intersection, and V1 struck V2. The front of V1 struck the left side of V2 in a T-type "
        "configuration.",
        {"V1": ("S", "straight"), "V2": ("E", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "Vehicle one (V1 - case vehicle), a 2003 Honda CRV, 4-door utility vehicle was traveling north on a "
        "freeway in the right lane. V1 came upon Vehicle two (V2), a 2000 International tractor pulling one "
        "semi-trailer that was traveling north at a slower speed. The front of V1 struck the rear of the "
        "trailer of V2.",
        {"V1": ("N", "straight"), "V2": ("N", None)}, {"V1": "front", "V2": "back"},
    ),
    (
        "Vehicle #1, a 1997 Nissan Altima, was traveling east in the right lane when it was struck in the "
        "left side by the front of Vehicle #2, a 2002 Toyota Tundra that was traveling south.",
        {"V1": ("E", "straight"), "V2": ("S", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 was traveling west in the left lane. V2, traveling in the opposite direction, attempted to turn "
        "left in front of V1. V2's right side was struck by V1's front.",
        {"V1": ("W", "straight"), "V2": ("E", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was northbound. As it crossed the intersection it was impacted on the right side by V2's front. "
        "V2 was westbound.",
        {"V1": ("N", "straight"), "V2": ("W", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 impacted with the right side of V2, with it's front. V1 was traveling south and V2 was traveling "
        "west.",
        {"V1": ("S", "straight"), "V2": ("W", "straight")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was stopped northbound in traffic. V2 was northbound behind V1. V3 was northbound behind V2. V3 "
        "struck V2 in the rear with its front, pushing V2 forward into the rear of V1.",
        {"V1": ("N", "stopped"), "V2": ("N", "straight"), "V3": ("N", "straight")}, {"V3": "front", "V2": "back"},
    ),
    (
        "V1 was eastbound in lane two and V2 was eastbound in lane one. As it changed lanes, V1's right front "
        "contacted the left rear of V2.",
        {"V1": ("E", None), "V2": ("E", "straight")}, None,
    ),
    (
        "V1 was westbound approaching the intersection. V2 was stopped on the northbound leg for the stop "
        "sign. V2 began to cross and was struck in the right front by the front of V1.",
        {"V1": ("W", "straight"), "V2": ("N", "straight")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was turning left from southbound to eastbound. V2 was northbound. V1's front struck V2's left "
        "side.",
        {"V1": ("S", "turn_left"), "V2": ("N", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was eastbound on the through street and V2 was northbound on the side street. V2 made a right "
        "turn onto the through street in front of V1, and the front of V1 struck the rear of V2.",
        {"V1": ("E", "straight"), "V2": ("N", "turn_right")}, {"V1": "front", "V2": "back"},
    ),
    (
        "Vehicle one was northbound in the left turn lane, stopped, waiting for the arrow. Vehicle two "
        "approached from behind. The front of vehicle two struck the rear of vehicle one.",
        {"V1": ("N", "stopped"), "V2": ("N", "straight")}, {"V2": "front", "V1": "back"},
    ),
    (
        "The crash occurred in the northbound lanes. V1 was traveling north in the first lane when it moved "
        "to the second lane to pass a slower vehicle. The left side of V1 contacted the right side of V2, "
        "which was in the second lane.",
        {"V1": ("N", None), "V2": ("N", "straight")}, {"V1": "left", "V2": "right"},
    ),
    (
        "V1 was southbound, drove through the stop sign and was hit on the passenger side by V2, which was "
        "heading west.",
        {"V1": ("S", "straight"), "V2": ("W", "straight")}, {"V2": "front", "V1": "right"},
    ),
    (
        "V1 was northbound and lost control negotiating a curve to the right on the wet road. V1 crossed the "
        "center line, rotated clockwise and its left side was struck by V2, southbound, front to side.",
        {"V1": ("N", "crossing_centerline"), "V2": ("S", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V2 was exiting a gas station, turning right to go east. V1 was eastbound. The right front of V1 "
        "struck the left rear of V2.",
        {"V1": ("E", "straight"), "V2": (None, "turn_right")}, None,
    ),
    (
        "Vehicle 1 was eastbound. The driver of Vehicle 2, westbound, misjudged the gap and turned left "
        "toward a side street. Contact occurred between the front of Vehicle 1 and the right side of Vehicle "
        "2.",
        {"V1": ("E", "straight"), "V2": ("W", "turn_left")}, {"V1": "front", "V2": "right"},
    ),
    (
        "Vehicle #1 had come to a stop behind a school bus. Vehicle #2 was following Vehicle #1 westbound and "
        "failed to stop, striking Vehicle #1 in the back end with its front end.",
        {"V1": ("W", "stopped"), "V2": ("W", "straight")}, {"V2": "front", "V1": "back"},
    ),
    (
        "V1 was in the northbound left lane and V2 in the northbound right lane. V2 made an illegal left turn "
        "from the right lane. V1's front struck V2's left side.",
        {"V1": ("N", "straight"), "V2": ("N", "turn_left")}, {"V1": "front", "V2": "left"},
    ),
    (
        "A pickup truck was traveling east on a county road. A sedan was traveling west. The pickup drifted "
        "across the center line and hit the sedan head-on.",
        {"V1": ("E", "crossing_centerline"), "V2": ("W", "straight")}, {"V1": "front", "V2": "front"},
    ),
    (
        "V1 was traveling southeast and V2 was traveling northwest on the highway. V2 crossed the grass "
        "median and the front of V1 struck the right side of V2.",
        {"V1": ("SE", "straight"), "V2": ("NW", "crossing_centerline")}, {"V1": "front", "V2": "right"},
    ),
    (
        "V1 was westbound attempting to make a u-turn from the shoulder. V2 was also westbound. The front of "
        "V2 struck the left side of V1.",
        {"V1": ("W", "u_turn"), "V2": ("W", "straight")}, {"V2": "front", "V1": "left"},
    ),
    (
        "V1 was slowing for a light, eastbound. V2 was following too closely and bumped the rear of V1.",
        {"V1": ("E", "slowing"), "V2": ("E", "straight")}, {"V2": "front", "V1": "back"},
    ),
    (
        "V1 ran into the rear of V2 while both were heading north on the interstate. V2 had slowed for "
        "construction.",
        {"V1": ("N", "straight"), "V2": ("N", "slowing")}, {"V1": "front", "V2": "back"},
    ),
    (
        "V1 was driving south. V2 pulled out from a stop sign on V1's right. The front of V1 hit the driver's "
        "side door of V2.",
        {"V1": ("S", "straight"), "V2": ("E", "straight")}, {"V1": "front", "V2": "left"},
    ),
    (
        "V1 was driving south. V2 pulled out from a driveway on V1's left. The front of V1 hit V2 on the "
        "right side.",
        {"V1": ("S", "straight"), "V2": ("W", None)}, {"V1": "front", "V2": "right"},
    ),
)  # fmt: skip


def _sides(facts: CrashFacts) -> dict[str, str]:
    first = facts.contacts[0]
    return {first.striker: first.striker_area, first.struck: first.struck_area}


@pytest.mark.parametrize(("text", "vehicles", "sides"), REPORTS)
def test_a_report_is_read_as_a_person_reads_it(text: str, vehicles: Statement, sides: dict[str, str] | None) -> None:
    facts = read(text).crash
    for name, (heading, maneuver) in vehicles.items():
        found = facts.vehicle(name)
        assert found is not None
        assert found.heading == heading or heading is None
        assert found.maneuver == maneuver or maneuver is None
    assert sides is None or _sides(facts) == sides


_SWAP = {"1": "2", "2": "1", "one": "two", "two": "one", "One": "Two", "Two": "One"}
_NUMBERED = re.compile(r"\b(Vehicle #?|V|Unit |vehicle )(1|2|one|two)\b")


def _swapped(text: str) -> str:
    return _NUMBERED.sub(lambda m: m.group(1) + _SWAP[m.group(2)], text)


def _two_told(text: str) -> bool:
    """Whether both directions are told, and no move is given to the first in number."""
    reading = read(text)
    facts = reading.crash
    if any(fact.rule in (OVER_MIDDLE, BESIDE) for fact in reading.facts):
        return False
    return len(facts.vehicles) == 2 and all(v.heading_stated for v in facts.vehicles) and bool(_NUMBERED.search(text))


@pytest.mark.parametrize("text", [t for t, _, _ in REPORTS if _two_told(t)])
def test_exchanging_the_numbers_exchanges_the_facts(text: str) -> None:
    facts, mirror = read(text).crash, read(_swapped(text)).crash
    for name, other in (("V1", "V2"), ("V2", "V1")):
        one, two = facts.vehicle(name), mirror.vehicle(other)
        assert one is not None
        assert two is not None
        assert (one.heading, one.maneuver, one.lane, one.speed_mph) == (
            two.heading, two.maneuver, two.lane, two.speed_mph)  # fmt: skip
    assert _sides(facts) == {{"V1": "V2", "V2": "V1"}[k]: v for k, v in _sides(mirror).items()}


@pytest.mark.parametrize(
    "spelling", ["Vehicle #{}", "Vehicle # {}", "V{}", "V {}", "Vehicle {}", "Unit {}", "VEHICLE #{}", "Veh. {}"]
)
@pytest.mark.parametrize("text", [t for t, _, _ in REPORTS if re.search(r"\bV1\b", t) and "(V1" not in t][:12])
def test_every_spelling_of_a_mention_gives_the_same_facts(text: str, spelling: str) -> None:
    rewritten = re.sub(r"\bV(\d)\b", lambda m: spelling.format(m.group(1)), text)
    assert read(rewritten).crash == read(text).crash


_SCRAPS = """V1 V2 V3 Vehicle #1 vehicle two the front rear left right side of struck was by with its turning
stopped traveling northbound east west in lane one . , and ( ) driver 45-year-old 30 mph The crash occurred
intersection pedestrian tree Critical Event for coded as this other opposite direction Ford Taurus both vehicles
it before avoid"""
_WORDS = st.sampled_from([*_SCRAPS.split(), "\n\n"])


@given(st.lists(_WORDS, max_size=60).map(" ".join))
@settings(max_examples=250, deadline=None)
def test_any_scrap_of_report_is_read_without_a_fault(text: str) -> None:
    facts = read(text).crash
    names = {v.id for v in facts.vehicles} | {o.id for o in facts.others}
    assert all({c.striker, c.struck} <= names and c.striker != c.struck for c in facts.contacts)


@given(st.text(max_size=200))
@settings(max_examples=150, deadline=None)
def test_any_text_is_read_without_a_fault(text: str) -> None:
    assert read(text).crash is not None


def test_a_text_without_vehicles_gives_no_facts() -> None:
    facts = read("The meeting was moved to Thursday.").crash
    assert facts.vehicles == ()
    assert facts.contacts == ()


def test_conditions_are_read_and_negations_are_not() -> None:
    facts = read(
        "V1 was eastbound. It was dark but the road was lighted, there was no rain and the road was dry."
    ).crash
    assert (facts.light, facts.weather, facts.surface) == ("dark_lit", None, "dry")


def test_an_interview_does_not_overrule_the_impact_paragraph() -> None:
    facts = read(
        "V1 was northbound. V2 was westbound. The front of V1 struck the left side of V2.\n\n"
        "The driver of V2 stated that the front of V2 struck the right side of V1."
    ).crash
    assert _sides(facts) == {"V1": "front", "V2": "left"}


def test_a_near_miss_and_a_stranger_are_no_contact() -> None:
    facts = read(
        "V1 was eastbound and braked to avoid striking a non-contact vehicle. V2, eastbound behind V1, struck the "
        "rear of V1."
    ).crash
    assert [(c.striker, c.struck) for c in facts.contacts] == [("V2", "V1")]
    assert len(facts.vehicles) == 2


def test_headings_that_are_not_told_follow_from_the_sides_that_touched() -> None:
    facts = read("V1 was traveling north. V2 failed to stop. The front of V2 struck the left side of V1.").crash
    found = facts.vehicle("V2")
    assert found is not None
    assert (found.heading, found.heading_stated) == ("E", False)


def test_make_model_year_and_kind_are_told_apart() -> None:
    facts = read("Vehicle #1, a red 1998 Ford F-150 pickup, was southbound. Vehicle #2 was a 2001 Kia Rio.").crash
    first, second = facts.vehicles
    assert (first.year, first.make, first.model, first.kind) == (1998, "Ford", "F-150", "pickup")
    assert (second.year, second.make, second.model, second.kind) == (2001, "Kia", "Rio", "car")


def test_a_volvo_v70_is_no_seventieth_vehicle() -> None:
    facts = read("Vehicle #1, a 2001 Volvo V70, was northbound. The Volvo V70 struck Vehicle #2 in the rear.").crash
    assert [v.id for v in facts.vehicles] == ["V1", "V2"]


def test_speed_lane_and_driveways_are_kept() -> None:
    facts = read(
        "V1 was eastbound in lane two at 40-50 km/h (25-31 mph). V2 was exiting a driveway on the right and turned "
        "left into the "
        "path of V1. The front of V1 struck the left side of V2."
    ).crash
    first, second = facts.vehicles
    assert (first.lane, first.speed_mph) == (2, 28)
    assert (second.origin, second.maneuver, second.heading) == ("driveway", "turn_left", "N")


def test_what_a_single_vehicle_hits_becomes_an_object() -> None:
    facts = read(
        "V1 was northbound, departed the right side of the road and struck a utility pole with its front."
    ).crash
    assert [(o.id, o.kind, o.word) for o in facts.others] == [("O1", "object", "pole")]
    assert facts.contacts[0].struck == "O1"


REDACTED = (
    "V1, a 1999 Honda Civic, was traveling north on a two-lane road. V2, a 2001 Ford Focus, was traveling south. "
    "The front of V1 struck the left side of V2 as it turned left into a side street.\n\nThe Honda (V1) was driven by "
    "a belted 40-year-old male who was not injured. He stated that he was traveling at 30 mph.\n\nV2 was driven by a "
    "51-year-old female who was transported. She said that she had slowed to 10 mph."
)


def test_facts_are_the_same_without_the_persons() -> None:
    bare = read(redact(REDACTED)).crash
    assert bare == read(REDACTED).crash
    assert [v.speed_mph for v in bare.vehicles] == [30, 10]


def test_they_after_both_vehicles_are_all_of_them() -> None:
    found = read("V1 and V2 were on a two-lane road. They were traveling north. V1 struck the back of V2.").crash
    assert [v.heading for v in found.vehicles] == ["N", "N"]


def test_a_slip_of_the_space_bar_hides_no_vehicle() -> None:
    found = read("V1 was traveling east. V2 was traveling west. The driver ofV2 drove across the center line.").crash
    assert found.vehicles[1].maneuver == "crossing_centerline"


def test_who_drives_in_the_opposing_lane_comes_over_the_line() -> None:
    found = read(
        "V1 was traveling east in the left eastbound lane of a freeway. V2 was traveling west in the left eastbound "
        "lane of the same road. The front of V2 struck the front of V1."
    ).crash
    assert [v.maneuver for v in found.vehicles] == ["straight", "crossing_centerline"]


@pytest.mark.parametrize(("told", "lane"), [
    ("in the fifth lane", 5), ("in the #3 lane", 3), ("in the number 2 lane", 2), ("in lane four", 4),
])  # fmt: skip
def test_lanes_are_read_by_number(told: str, lane: int) -> None:
    assert read(f"V1 was traveling north {told} of a ten-lane freeway.").crash.vehicles[0].lane == lane


def test_the_trailer_of_a_vehicle_is_its_own_whoever_is_named_behind_it() -> None:
    told = read("V1 and V2 were northbound. V2 turned right and the right side of V2's trailer contacted V1.").crash
    assert [v.trailer for v in told.vehicles] == [False, True]


def test_one_trailer_is_a_trailer() -> None:
    found = read("V1, a 2004 Freightliner tractor pulling one trailer, was traveling east.").crash
    assert found.vehicles[0].trailer


def test_a_ramp_is_known_through_all_its_adjectives() -> None:
    found = read("V1 was traveling northeast on a one-lane, one-way freeway entrance ramp and merged.").crash
    assert found.vehicles[0].origin == "ramp"


@pytest.mark.parametrize(("told", "light"), [
    ("It was dark and there were no streetlights.", "dark"), ("It was dark but the road was lighted.", "dark_lit"),
    ("It was dark, with streetlights.", "dark_lit"), ("It was dark and unlighted.", "dark"),
])  # fmt: skip
def test_lamps_light_a_road_only_where_there_are_some(told: str, light: str) -> None:
    assert read(f"V1 was traveling east. {told}").crash.light == light


@pytest.mark.parametrize(("told", "started"), [
    ("V1 stopped at the stop sign. V1 then proceeded into the intersection.", True),
    ("V1 was stopped in the left turn lane and began to turn left.", True),
    ("V1 was attempting a left turn. V1 had a stop sign and had stopped before initiating its turn.", True),
    ("Witnesses said that V1 came to a complete stop. V1 then entered the intersection.", True),
    ("V1 continued through the green light.", False),
    ("V1 was stopped at a red light.", False),
])  # fmt: skip
def test_who_stood_and_moved_on_starts_from_a_stop(told: str, started: bool) -> None:
    found = read(f"V1 was traveling north. {told} V2 was traveling west. V2 struck the right of V1.").crash
    assert found.vehicles[0].from_stop == started


def test_to_be_passed_by_is_not_to_overtake() -> None:
    found = read("V1 was eastbound. V2 was northbound and turned left. As V1 passed by V2, V2 contacted V1.").crash
    assert found.vehicles[0].maneuver == "straight"


def test_speeds_in_brackets_count() -> None:
    assert read("V1 was traveling north between 34 and 48 kmph (21 and 30 mph).").crash.vehicles[0].speed_mph == 26


def test_a_parked_vehicle_stands_along_the_road() -> None:
    found = read("V1 was traveling east. V2 was parked at the left edge. V1's front struck V2's right side.").crash
    assert found.vehicles[1].heading in ("E", "W")


def test_who_negotiates_the_curve_of_a_ramp_is_on_it() -> None:
    assert read("V1 was negotiating the right curve of the ramp.").crash.vehicles[0].origin == "ramp"


@pytest.mark.parametrize(("told", "weather"), [
    ("The driver of V1 mistimed the turn.", None), ("The window of V1 was fogged over.", None),
    ("It was misty.", "fog"), ("There was fog.", "fog"),
])  # fmt: skip
def test_a_mistake_is_no_mist(told: str, weather: str | None) -> None:
    assert read(f"V1 was traveling east. {told}").crash.weather == weather


def test_letting_others_pass_is_not_overtaking() -> None:
    found = read("V1 was traveling north when it slowed to allow several vehicles to pass. V2 struck V1.").crash
    assert found.vehicles[0].maneuver != "overtaking"


@pytest.mark.parametrize(("second", "sides"), [
    ("V2 was eastbound and passed behind it.", {"V1": "left", "V2": "right"}),
    ("V2 was backing west.", {"V1": "back", "V2": "back"}),
])  # fmt: skip
def test_two_rear_corners_touch_with_their_flanks_unless_somebody_backs(second: str, sides: dict[str, str]) -> None:
    text = f"V1 was stopped facing north. {second} The right rear corner of V2 contacted the left rear corner of V1."
    found = read(text).crash.contacts[0]
    assert {found.striker: found.striker_area, found.struck: found.struck_area} == sides


def test_a_corner_whose_flank_is_not_told_may_be_any_of_its_sides() -> None:
    text = "V1 was northbound. V2 was northbound ahead of it. The right side of V1 struck the rear corner of V2."
    first = read(text).crash.contacts[0]
    assert (first.struck_area, first.struck_may, first.areas_stated) == ("back", ("back", "left", "right"), False)
    assert (first.striker_area, first.striker_may) == ("right", ("right",))


@pytest.mark.parametrize(("text", "meant"), [
    ("V2 stopped to turn left and V1 rear-ended V2.", "turn_left"),
    ("V2 stopped at the intersection to take a right turn. The front of V1 struck the back of V2.", "turn_right"),
    ("V2 was stopped and attempting a left turn into a lot. The front of V1 struck the back of V2.", "turn_left"),
    ("V2 stopped for traffic. The front of V1 struck the back of V2.", None),
])  # fmt: skip
def test_a_turn_that_is_told_behind_a_stop_is_meant(text: str, meant: str | None) -> None:
    vehicle = read(f"V1 and V2 were westbound. {text}").crash.vehicle("V2")
    assert vehicle is not None
    assert (vehicle.maneuver, vehicle.meant) == ("stopped", meant)


@pytest.mark.parametrize(("sides", "corners"), [
    ("left front of V1 struck the right rear of V2", {"V1": ("front", "left"), "V2": ("back", "right")}),
    ("front of V1 struck the left rear of V2", {"V2": ("back", "left")}),
    ("front of V1 struck the back of V2", {}),
])  # fmt: skip
def test_a_told_corner_is_planned_for(sides: str, corners: dict[str, tuple[str, str]]) -> None:
    courses = read(f"V1 was northbound. V2 was eastbound. The {sides}.").crash.driven
    assert {name: course.corner for name, course in courses.items() if course.corner} == corners

-- Tests a joint of the robot. rtf calls setup, run and tearDown, in a separate process for each test.

local goal, position = 90, 0

-- A stand-in for the robot.
local function step()
  position = position + 15
  return position
end

TestCase = {}

-- Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
function TestCase.setup(args)
  goal = tonumber(args[1] or goal)
end

-- Test here. The first problem decides the verdict.
function TestCase.run()
  -- Ends the test if it takes longer than 5 s.
  rtf.wait_until(function() return step() >= goal end, 5, "the joint at its goal")
  -- A failed check does not end the test.
  rtf.check_near(position, goal, 0.5, "joint")
  -- Stored with the result, and checked against the limits.
  rtf.measure("position", position, "deg", 0, 180)
end

-- Leave the robot as it was. rtf always calls it.
function TestCase.tearDown()
  position = 0
end

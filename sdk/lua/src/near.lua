-- Near equality of numbers, vectors and angles.
--
-- compare(got, expected, tolerance, is_angle) returns the protocol's `comparison` (nil if
-- it is too long), and a description of the problem, or nil.
local text = ...

local HUGE = math.huge
local TURN = 2 * math.pi

-- Above this many numbers only the text is sent: a line of the protocol has a limit.
local MAX_NUMBERS = 100000

local near = {}

local function is_finite(number)
  return number == number and number ~= HUGE and number ~= -HUGE
end

-- Appends the numbers of a number, a vector or a matrix, row by row.
local function flatten(value, what, numbers)
  if math.type(value) then
    numbers[#numbers + 1] = value + 0.0
  elseif type(value) == "table" then
    for index = 1, #value do
      flatten(value[index], what, numbers)
    end
  else
    error(("%s is neither a number nor a table of numbers: %s"):format(what, tostring(value)), 0)
  end
  return numbers
end

local function difference(got, expected, is_angle)
  if not (is_finite(got) and is_finite(expected)) then
    return nil
  end
  local off = math.abs(got - expected)
  if is_angle then
    off = math.fmod(off, TURN)
    off = math.min(off, TURN - off)
  end
  return off
end

-- The index with the largest difference; non-finite numbers come first.
local function worst(got, expected, is_angle)
  local index, largest
  for i = 1, #got do
    local off = difference(got[i], expected[i], is_angle)
    if not off then
      return i, nil
    end
    if not largest or off > largest then
      index, largest = i, off
    end
  end
  return index, largest
end

function near.compare(got, expected, tolerance, is_angle)
  if not math.type(tolerance) or not is_finite(tolerance) or tolerance < 0 then
    error(("the tolerance %s is not a finite number from 0"):format(tostring(tolerance)), 0)
  end
  local is_scalar = math.type(got) and math.type(expected)
  local comparison = {
    got = flatten(got, "what was got", {}),
    expected = flatten(expected, "what is expected", {}),
    tolerance = tolerance + 0.0,
  }
  local count = #comparison.got
  local sent = count + #comparison.expected <= MAX_NUMBERS and comparison or nil
  if count ~= #comparison.expected then
    return sent, ("got %d values, expected %d"):format(count, #comparison.expected)
  end
  local index, off = worst(comparison.got, comparison.expected, is_angle)
  if not is_scalar and index then
    comparison.worst = index - 1
  end
  if not index or (off and off <= tolerance) then
    return sent, nil
  end
  local problem = ("got %s, expected %s ± %s"):format(text.number(comparison.got[index]),
    text.number(comparison.expected[index]), text.number(tolerance))
  if off then
    problem = ("%s (off by %s)"):format(problem, text.number(off))
  end
  if not is_scalar then
    problem = ("%s at index %d"):format(problem, index - 1)
  end
  return sent, problem
end

return near

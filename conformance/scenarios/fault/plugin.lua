local function ticks()
  local file = assert(io.open("tick"))
  local count = file:read("n")
  file:close()
  return count
end

local function stands()
  local before = ticks()
  rtf.sleep(0.15)
  return ticks() == before
end

function TestCase.run()
  do
    local lost <close> = rtf.fault("drop")
    rtf.check(stands(), "the camera stands")
    lost:remove()
  end
  local before = ticks()
  rtf.wait_until(function()
    return ticks() > before
  end, 30, "the camera to run")
  rtf.fault("drop")
  rtf.check(stands(), "the camera stands again")
  rtf.fault("drop")
  rtf.report("not reached")
end

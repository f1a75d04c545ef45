function TestCase.run()
  local start = rtf.now()
  rtf.sleep(20)
  rtf.check(rtf.now() - start >= 20, "twenty seconds have passed")
  rtf.wait_until(function()
    return false
  end, 10, "the door to open")
end

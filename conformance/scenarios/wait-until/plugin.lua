function TestCase.run()
  rtf.wait_until(function()
    return false
  end, 0.2, "the door to open")
end

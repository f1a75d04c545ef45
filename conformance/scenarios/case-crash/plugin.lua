function TestCase.run()
  local poses = {}
  for number = 1, 40 do
    poses[number] = "pose " .. number
  end
  rtf.plan_cases(poses)
  for number, pose in ipairs(poses) do
    rtf.case(pose, function()
      if number == 7 then
        os.execute("kill -SEGV $PPID")
      end
    end)
  end
end

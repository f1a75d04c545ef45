with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Session;

package body Endings is

   package Session renames RobotTestingFramework.Session;

   procedure Tell_Session is
   begin
      Report
        (Session.Name & ", " & Session.Parameters & ", " & Session.Environment & ","
         & Session.Repetition'Image & "," & Session.Argument_Count'Image);
      Report (Session.Argument (Session.Argument_Count));
   end Tell_Session;

   --  A check of the compiler raises an exception.
   procedure Read_Beyond is
      Joints : constant Numbers := (1.0, 2.0);
      Joint  : constant Natural := Session.Argument_Count + 7;
   begin
      Report (Joints (Joint)'Image);
   end Read_Beyond;

   --  The failure was recorded before the plug-in catches the exception.
   procedure Catch is
   begin
      Require (False, "caught");
   exception
      when others =>
         Report ("went on");
   end Catch;

   overriding procedure Run (Self : in out Test) is
      pragma Unreferenced (Self);
      Ending : constant String := Session.Argument (1);
      Turns  : Natural         := 0;

      function Enough return Boolean is
      begin
         Turns := Turns + 1;
         return Turns > 3;
      end Enough;
      procedure Wait is new Session.Wait_Until (Enough);

      Zero : constant Long_Float := Long_Float (Turns);
   begin
      if Ending = "session" then
         Tell_Session;
      elsif Ending = "beyond" then
         Read_Beyond;
      elsif Ending = "catch" then
         Catch;
      elsif Ending = "wait" then
         Wait (10.0, "enough turns");
         Check (Turns = 4, "four turns");
      elsif Ending = "numbers" then
         Check_Near ((1.0, 2.0), (1 => 1.0), 0.1, "length");
         Check_Near (Zero / Zero, 0.0, 0.1, "sensor");
         Check_Near (Numbers'(2 .. 1 => 0.0), Numbers'(2 .. 1 => 0.0), 0.0, "nothing");
         Session.Measure ("rate", Zero / Zero);
         Require_Angle_Near (0.0, 1.0, 0.1, "yaw");
      elsif Ending = "tolerance" then
         Check_Near (0.0, 0.0, -1.0, "negative");
      elsif Ending = "attach" then
         Session.Attach ("/nowhere/trace.csv");
      end if;
   end Run;

   overriding procedure TearDown (Self : in out Test) is
      pragma Unreferenced (Self);
   begin
      Session.Sleep (0.0);
      Report ("torn down");
   end TearDown;

end Endings;

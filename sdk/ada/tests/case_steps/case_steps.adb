with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Case_Steps is

   --  The compiler's check of an index reports its location.
   procedure Run_Nested_Cases is
      Moved : Natural := 0;

      procedure Move is
         Joints : constant Numbers := (1.0, 2.0);
      begin
         Moved := Moved + 1;
         Report (Joints (Moved + 2)'Image);
      end Move;

      procedure Arm is
      begin
         Run_Case ("moves", Move'Access);
         Report ("moved" & Moved'Image);
      end Arm;
   begin
      Run_Case ("arm", Arm'Access, (Named ("joint", -3), Named ("side", "left")));
      Run_Case ("hand", Arm'Access, (1 => Named ("empty", "")));
   end Run_Nested_Cases;

   procedure Read_Matrix is
   begin
      Report (Parameter ("side") & "," & Parameter_Values'Length'Image);
      Report (Parameter ("speed"));
   end Read_Matrix;

   procedure Wait_In_Case is
      procedure Wait is
      begin
         Sleep (60.0);
      end Wait;
   begin
      Run_Case ("waits", Wait'Access);
      Report ("after the stop request");
   end Wait_In_Case;

   overriding procedure Run (Self : in out Test) is
      pragma Unreferenced (Self);
      Step : constant String := Argument (1);
   begin
      if Step = "nested" then
         Run_Nested_Cases;
      elsif Step = "matrix" then
         Read_Matrix;
      elsif Step = "wait" then
         Wait_In_Case;
      end if;
   end Run;

   overriding procedure TearDown (Self : in out Test) is
      pragma Unreferenced (Self);

      procedure Never is
      begin
         Report ("never");
      end Never;
   begin
      if Argument (1) = "late" then
         Run_Case ("late", Never'Access);
         Skip ("late");
      end if;
   end TearDown;

end Case_Steps;

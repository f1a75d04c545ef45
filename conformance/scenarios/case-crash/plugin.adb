with Interfaces.C;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;
with System.Storage_Elements; use System.Storage_Elements;
with System; use System;

package body Plugin is

   procedure Pass is null;

   function Pose (Number : Positive) return String is ("pose" & Number'Image);

   overriding procedure Run (Self : in out Test) is
      --  Reads unmapped memory, in C.
      function C_Length (Text : Address) return Interfaces.C.size_t
        with Import, Convention => C, External_Name => "strlen";

      procedure Crash is
      begin
         Report (C_Length (To_Address (1))'Image);
      end Crash;

      Poses : Case_Names (1 .. 40);
   begin
      for Number in Poses'Range loop
         Poses (Number) := +Pose (Number);
      end loop;
      Plan_Cases (Poses);
      for Number in Poses'Range loop
         Run_Case (Pose (Number), (if Number = 7 then Crash'Access else Pass'Access));
      end loop;
   end Run;

end Plugin;
